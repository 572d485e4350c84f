import { Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact, counted } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { FiguresTable } from "../FiguresTable";
import type { Study } from "../study";
import { curveOf, rowsOf, type TorqueFound } from "./points";

/** The curve with its intervals, and the same as a table. */
export function Results({ study }: { study: Study }) {
  const found = study.torque;
  return found && found.points.length > 0 ? <Found found={found} /> : null;
}

function Found({ found }: { found: TorqueFound }) {
  const scheme = useScheme();
  const torque = found.inertia_kgm2 !== null;
  const unit = torque ? "N m" : "rad/s²";
  const name = torque ? "torque" : "acceleration";
  const rows = rowsOf(found.points);
  const edge = colorOf("residual", scheme);
  const summary = found.margin
    ? `At its worst speed ${compact(found.margin.times, 3)} times what the ramp asks for is there`
    : `${counted(rows.length, "speed")} so far`;
  return (
    <Card title="Torque over speed" note={summary}>
      <Plot
        label="Torque over speed"
        summary={summary}
        height={220}
        series={[
          { label: name, unit, color: colorOf("velocity", scheme), dots: 6, line: true },
          { label: "95 %, from", unit, color: edge },
          { label: "to", unit, color: edge },
        ]}
        x={{ label: "speed", unit: "turns/s" }}
        scales={{ y: { label: name, unit, include: [0] } }}
        data={curveOf(rows)}
      />
      <FiguresTable
        label="Torque at each speed"
        minWidth={320}
        heads={["turns/s", unit, "95 %"]}
        rows={rows.map(({ speed, value, low, high }) => [
          compact(speed, 3),
          compact(value, 3),
          `${compact(low, 3)} to ${compact(high, 3)}`,
        ])}
      />
      <Text size="sm" className="dim">
        {torque && found.friction_nm > 0
          ? `With the ${compact(found.friction_nm)} N m of friction that were told.`
          : "Beyond the friction of the axis: what is left for load and acceleration."}
      </Text>
    </Card>
  );
}
