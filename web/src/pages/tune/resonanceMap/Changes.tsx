import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { FiguresTable } from "../FiguresTable";
import { type Change, changeOf } from "./dots";

/** What a change makes of the ripple at each speed, with how sure that is. */
export function ChangeCard({ change }: { change: Change }) {
  const scheme = useScheme();
  const summary = summaryOf(change);
  return (
    <Card title={`With ${change.name}`} note={summary}>
      <Plot
        label={`Ripple over speed, without and with ${change.name}`}
        summary={summary}
        height={190}
        series={[
          { label: "as it is set", unit: "°", color: colorOf("target_velocity", scheme), dots: 5, line: true },
          { label: change.name, unit: "°", color: colorOf("velocity", scheme), dots: 5, line: true },
        ]}
        x={{ label: "speed", unit: "turns/s" }}
        scales={{ y: { label: "ripple, electrical", unit: "°", include: [0] } }}
        data={changeOf(change)}
      />
      <FiguresTable
        label={`Ripple with ${change.name}`}
        minWidth={320}
        heads={["turns/s", "as it is", "with it", "difference, 95 %", ""]}
        rows={change.points.map(({ speed_rps, before_deg, after_deg, interval_deg, told }) => [
          compact(speed_rps, 3),
          `${compact(before_deg, 3)}°`,
          `${compact(after_deg, 3)}°`,
          `${compact(interval_deg.low, 2)} to ${compact(interval_deg.high, 2)}°`,
          told,
        ])}
      />
    </Card>
  );
}

function summaryOf({ difference_deg: difference, before_deg: before, lost_rps: lost }: Change): string {
  if (lost.length > 0) return `loses steps at ${lost.map((speed) => compact(speed, 3)).join(", ")} turns/s`;
  if (difference === null || !before) return "too few runs to compare";
  const percent = compact(Math.abs((100 * difference) / before), 3);
  return `${percent} % ${difference < 0 ? "less" : "more"} ripple, mean of all speeds`;
}
