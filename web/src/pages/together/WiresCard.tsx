import { Code, Table, Text } from "@mantine/core";
import { Card } from "../../lib/Card";
import { type Net, netText } from "./starts";
import classes from "./together.module.css";

const EXAMPLE = '"wires": [{"pin": "START", "net": "start"}]';

/** Which pins of emulated devices are wired together. */
export function WiresCard({ nets }: { nets: readonly Net[] }) {
  return (
    <Card title="Wires" note="between emulated devices">
      {nets.length > 0 && (
        <Table className={classes.table} verticalSpacing={4} data-testid="nets">
          <Table.Thead>
            <Table.Tr>
              <Table.Th>Net</Table.Th>
              <Table.Th>Pins</Table.Th>
              <Table.Th>State</Table.Th>
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {nets.map((net) => (
              <Table.Tr key={net.net}>
                <Table.Td>{net.net}</Table.Td>
                <Table.Td>{net.pins.map(({ device, pin }) => `${device} ${pin}`).join(", ")}</Table.Td>
                <Table.Td className={net.open === null ? "" : "caution"}>{netText(net)}</Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      )}
      <Text size="xs" c="dimmed" mt={nets.length > 0 ? "xs" : 0}>
        {nets.length === 0 && "No emulated device is wired to another one. "}A wire is an option of an emulated device's
        link, over REST: pins that name the same net are connected, START with START, or STEP1 of a controller with that
        of a driver. <Code>{EXAMPLE}</Code>
      </Text>
    </Card>
  );
}
