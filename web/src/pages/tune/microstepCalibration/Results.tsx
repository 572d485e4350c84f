import { Table, Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import type { Study } from "../study";
import { addedOf, errorOf, harmonicsOf, type Microsteps } from "./curves";

/** The error over the electrical angle before and after, its harmonics, how sure, and the table itself. */
export function Results({ study }: { study: Study }) {
  const found = study.microsteps;
  return found ? <Found found={found} /> : null;
}

function Found({ found }: { found: Microsteps }) {
  const scheme = useScheme();
  const before = colorOf("target_position", scheme);
  const after = colorOf("position", scheme);
  const perDegree = found.microsteps_per_deg;
  const { before: was, after: now, effect } = found;
  const summary =
    `${compact(was.rms_deg, 3)}° electrical before (${compact(was.rms_deg * perDegree, 3)} µsteps)` +
    (now ? `, ${compact(now.rms_deg, 3)}° with the new table` : "");
  return (
    <>
      <Card title="Angle error" note={summary}>
        <Plot
          label="Error over the electrical angle"
          summary={summary}
          height={220}
          series={[
            { label: "before", unit: "°", color: before },
            { label: "expected", unit: "°", color: colorOf("residual", scheme) },
            { label: "after", unit: "°", color: after },
          ]}
          x={{ label: "commanded electrical angle", unit: "°" }}
          scales={{ y: { label: "error", unit: "°" } }}
          data={errorOf(found)}
        />
        <Harmonics found={found} />
      </Card>
      {effect && (
        <Card title="How sure" note={effect.significant ? "better" : "not shown to be better"}>
          <Text size="sm">
            {compact(effect.difference_deg, 3)}° on average of {effect.pairs} pairs, 95 %:{" "}
            {compact(effect.interval_deg.low, 3)} to {compact(effect.interval_deg.high, 3)}°; p {compact(effect.p, 2)}.
            Expected to be left: {compact(found.predicted_rms_deg, 3)}°; no such table takes away{" "}
            {compact(found.beyond_rms_deg, 3)}°.
          </Text>
        </Card>
      )}
      {found.wave && (
        <Card title="Table" note="new less old">
          <Plot
            label="What the new table adds to the one before"
            height={170}
            series={[{ label: "new less old", unit: "counts", color: after, stepped: true }]}
            x={{ label: "place in the quarter wave" }}
            scales={{ y: { label: "current", unit: "counts" } }}
            data={addedOf(found)}
          />
        </Card>
      )}
    </>
  );
}

function Harmonics({ found }: { found: Microsteps }) {
  return (
    <Table mt="xs" withRowBorders={false} verticalSpacing={2} aria-label="Harmonics of the angle error">
      <Table.Thead>
        <Table.Tr>
          <Table.Th scope="col">Order</Table.Th>
          <Table.Th scope="col">Before [°]</Table.Th>
          <Table.Th scope="col">After [°]</Table.Th>
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {harmonicsOf(found).map(({ order, before, beforeHalf, after, afterHalf }) => (
          <Table.Tr key={order}>
            <Table.Th scope="row">{order}</Table.Th>
            <Table.Td className="num">
              {compact(before, 3)} ± {compact(beforeHalf, 2)}
            </Table.Td>
            <Table.Td className="num">
              {after === null ? "" : `${compact(after, 3)} ± ${compact(afterHalf ?? 0, 2)}`}
            </Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}
