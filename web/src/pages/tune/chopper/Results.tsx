import { Table, Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import type { Study } from "../study";
import { type ChopperFound, namedOf, rippleOf } from "./tried";

/** How much the shaft shook by which setting, and how sure the best one is. */
export function Results({ study }: { study: Study }) {
  const found = study.chopper;
  return found && found.before !== null ? <Found found={found} /> : null;
}

function Found({ found }: { found: ChopperFound }) {
  const scheme = useScheme();
  const { effect } = found;
  return (
    <Card title="Chopper" note={`${found.tried.length} tried`}>
      <Plot
        label="Ripple over hysteresis"
        height={190}
        series={[
          { label: "tried", color: colorOf("velocity", scheme), dots: 7, line: false },
          { label: "before", color: colorOf("residual", scheme), dots: 9, line: false },
        ]}
        x={{ label: "hysteresis" }}
        scales={{ y: { label: "ripple", unit: "full steps", include: [0] } }}
        data={rippleOf(found)}
      />
      <Table.ScrollContainer minWidth={320} type="native">
        <Table mt="xs" withRowBorders={false} verticalSpacing={2} aria-label="Choppers">
          <Table.Thead>
            <Table.Tr>
              <Table.Th scope="col" />
              <Table.Th scope="col">TOFF</Table.Th>
              <Table.Th scope="col">TBL</Table.Th>
              <Table.Th scope="col">Hysteresis</Table.Th>
              <Table.Th scope="col">Ripple</Table.Th>
              <Table.Th scope="col">Chopper, about</Table.Th>
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {namedOf(found).map(([name, one]) => (
              <Table.Tr key={name}>
                <Table.Th scope="row">{name}</Table.Th>
                <Table.Td className="num">{one.off}</Table.Td>
                <Table.Td className="num">{one.blank}</Table.Td>
                <Table.Td className="num">{one.hysteresis}</Table.Td>
                <Table.Td className="num">{compact(one.ripple_fullsteps, 3)} full steps</Table.Td>
                <Table.Td className="num">{compact(one.chopper_hz / 1e3, 3, "kHz")}</Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      </Table.ScrollContainer>
      {effect && (
        <Text size="sm">
          New less old, {effect.pairs} pairs: {compact(effect.difference_fullsteps, 3)} full steps (95 %:{" "}
          {compact(effect.interval_fullsteps.low, 3)} to {compact(effect.interval_fullsteps.high, 3)}), p{" "}
          {compact(effect.p, 2)}.
        </Text>
      )}
    </Card>
  );
}
