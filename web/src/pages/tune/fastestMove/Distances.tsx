import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { FiguresTable } from "../FiguresTable";
import type { Study } from "../study";
import { timesOf } from "./moves";

/** What each of several distances takes, before and with the best setting. */
export function Distances({ study }: { study: Study }) {
  const rows = timesOf(study);
  if (rows.length === 0) return null;
  const told = (time: number | null) => (time === null ? "" : compact(time, 3, "s"));
  return (
    <Card title="Each distance">
      <FiguresTable
        label="Time of each distance"
        minWidth={280}
        heads={["Microsteps", "Before", "Best"]}
        rows={rows.map(({ name, before, best }) => [name, told(before), told(best)])}
      />
    </Card>
  );
}
