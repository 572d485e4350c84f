import type { RegisterRow } from "../../../lib/rows/bits";
import { type Key, keyOf } from "../../../lib/rows/staging";
import type { Reading } from "../../../lib/rows/useRegisters";

/** Parameters that the module's firmware does not have: left out of an answer that has others of their group. */
export function lackingOf(rows: readonly RegisterRow[], readings: ReadonlyMap<Key, Reading>): ReadonlySet<Key> {
  const answered = new Set(rows.filter((row) => readings.has(keyOf(row))).map(({ group }) => group));
  const left = rows.filter(
    (row) => row.access !== "W" && !row.read_clears && answered.has(row.group) && !readings.has(keyOf(row)),
  );
  return new Set(left.map((row) => keyOf(row)));
}
