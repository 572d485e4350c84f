import { colorOf } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { numbersOf } from "./numbers";
import classes from "./twin.module.css";
import type { TwinState } from "./useTwin";

/** The picture in numbers. */
export function TwinNumbers({ state }: { state: TwinState }) {
  const scheme = useScheme();
  return (
    <dl className={`${classes.numbers} grid gap-4 m-0`}>
      {numbersOf(state).map((row) => (
        <div key={row.name} data-known={row.known}>
          <dt>
            <span
              className={`${classes.swatch} swatch`}
              style={{ background: row.known && row.quantity ? colorOf(row.quantity, scheme) : undefined }}
              aria-hidden
            />
            {row.name}
          </dt>
          <dd className="num">{row.value}</dd>
          <dd className={classes.note}>{row.note}</dd>
        </div>
      ))}
    </dl>
  );
}
