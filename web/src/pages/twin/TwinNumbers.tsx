import { colorOf } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { numbersOf } from "./numbers";
import classes from "./twin.module.css";
import type { TwinState } from "./useTwin";

/** The picture in numbers. */
export function TwinNumbers({ state }: { state: TwinState }) {
  const scheme = useScheme();
  return (
    <dl className={`${classes.numbers} stacked grid gap-4 m-0 text-13 tight`}>
      {numbersOf(state).map((row) => (
        <div key={row.name} className={row.known ? "" : "dim"}>
          <dt className="row gap-6">
            <span
              className="swatch hue-grey"
              style={{ background: row.known && row.quantity ? colorOf(row.quantity, scheme) : undefined }}
              aria-hidden
            />
            {row.name}
          </dt>
          <dd className="num right">{row.value}</dd>
          <dd className={`${classes.note} whole hint`}>{row.note}</dd>
        </div>
      ))}
    </dl>
  );
}
