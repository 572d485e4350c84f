import { Table } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
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
      <Table.ScrollContainer minWidth={320} type="native">
        <Table mt="xs" withRowBorders={false} verticalSpacing={2} aria-label={`Ripple with ${change.name}`}>
          <Table.Thead>
            <Table.Tr>
              <Table.Th scope="col">turns/s</Table.Th>
              <Table.Th scope="col">as it is</Table.Th>
              <Table.Th scope="col">with it</Table.Th>
              <Table.Th scope="col">difference, 95 %</Table.Th>
              <Table.Th scope="col" />
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {change.points.map((point) => (
              <Table.Tr key={point.speed_rps}>
                <Table.Th scope="row">{compact(point.speed_rps, 3)}</Table.Th>
                <Table.Td className="num">{compact(point.before_deg, 3)}°</Table.Td>
                <Table.Td className="num">{compact(point.after_deg, 3)}°</Table.Td>
                <Table.Td className="num">
                  {compact(point.interval_deg.low, 2)} to {compact(point.interval_deg.high, 2)}°
                </Table.Td>
                <Table.Td>{point.told}</Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      </Table.ScrollContainer>
    </Card>
  );
}

function summaryOf({ difference_deg: difference, before_deg: before, lost_rps: lost }: Change): string {
  if (lost.length > 0) return `loses steps at ${lost.map((speed) => compact(speed, 3)).join(", ")} turns/s`;
  if (difference === null || !before) return "too few runs to compare";
  const percent = compact(Math.abs((100 * difference) / before), 3);
  return `${percent} % ${difference < 0 ? "less" : "more"} ripple, mean of all speeds`;
}
