import { type CSSProperties, useState } from "react";
import { bitOf, enumName, type RegisterRow, segments, unpackField, WORD_BITS, writable } from "../../lib/rows/bits";
import css from "./registers.module.css";

interface Props {
  row: RegisterRow;
  /** null: not known */
  raw: number | null;
  /** the word as it will be; bits that differ are marked */
  staged: number | null;
  onPick?: (field: string) => void;
}

/** The word as the data sheet draws it: bit numbers, named stretches, and what each bit is now. */
export function BitStrip({ row, raw, staged, onPick }: Props) {
  const [under, setUnder] = useState<string | null>(null);
  const total = Math.max(WORD_BITS, row.width);
  const shown = staged ?? raw;
  const parts = segments(row);
  // As in the data sheets: a name that is longer than its bits are wide stands upright.
  const upright = (name: string, width: number) => name.length > 3.4 * width;
  const longest = parts.reduce((most, { field, msb, lsb }) => {
    const fits = field === null || !upright(field.name, msb - lsb + 1);
    return fits ? most : Math.max(most, field.name.length);
  }, 0);
  return (
    <div>
      <div
        className={`${css.strip} grid text-12 mono`}
        style={{ "--bits": total, "--name": longest === 0 ? "17px" : `${longest + 1}ch` } as CSSProperties}
        role="img"
        aria-label={`${row.name}, ${row.width} bits, ${
          raw === null ? "not known" : raw.toString(2).padStart(row.width, "0")
        }`}
      >
        {parts.map((part) => {
          const width = part.msb - part.lsb + 1;
          const name = part.field?.name ?? (part.whole ? row.name : "");
          const meaningful = part.field !== null || part.whole;
          const value =
            part.field && shown !== null
              ? (enumName(part.field, unpackField(shown, part.field)) ?? String(unpackField(shown, part.field)))
              : "";
          const access = part.field?.access ?? row.access;
          return (
            // Pointers only: the same fields stand below as labelled controls.
            // biome-ignore lint/a11y/noStaticElementInteractions: a shortcut for the mouse
            // biome-ignore lint/a11y/useKeyWithClickEvents: a shortcut for the mouse
            <div
              key={part.lsb}
              className={css.segment}
              data-kind={!meaningful ? "gap" : writable(access) ? "write" : "read"}
              data-under={name !== "" && name === under}
              style={{ gridColumn: `span ${width}` }}
              title={meaningful ? `${name}${value ? ` = ${value}` : ""}` : "no meaning"}
              onMouseEnter={() => setUnder(name)}
              onMouseLeave={() => setUnder(null)}
              onClick={() => part.field && onPick?.(part.field.name)}
            >
              <div
                className={`${css.segmentName} flex end text-12 mono tight nowrap`}
                data-upright={upright(name, width)}
              >
                {name}
              </div>
              <div className="flex">
                {Array.from({ length: width }, (_, index) => {
                  const bit = part.msb - index;
                  const old = raw === null ? null : bitOf(raw, bit);
                  const now = shown === null ? null : bitOf(shown, bit);
                  return (
                    <span
                      key={bit}
                      className={`${css.bit} grow shrink centered`}
                      data-on={now === 1}
                      data-staged={staged !== null && old !== now}
                    >
                      <span className={`${css.bitNumber} hint block mono`}>{bit}</span>
                      <span className={`${css.bitValue} block text-13 mono tight`}>
                        {meaningful ? (now ?? "?") : "·"}
                      </span>
                    </span>
                  );
                })}
              </div>
            </div>
          );
        })}
      </div>
    </div>
  );
}
