import { Button, Group, Table, Text } from "@mantine/core";
import { IconPlugConnected } from "@tabler/icons-react";
import { Link } from "wouter";
import { EmptyState } from "../../lib/EmptyState";
import { duration, fixed, sizeText } from "../../lib/format";
import { StateDot } from "../../lib/StateDot";
import classes from "./health.module.css";
import type { DeviceHealth } from "./useHealth";

const NUMBERS = [
  "Waiting",
  "Longest wait",
  "Sent",
  "Received",
  "Failed",
  "Timeouts",
  "Readers",
  "Rows dropped",
] as const;

/** Every device with its link, its queue and its readers. */
export function DevicesTable({ devices }: { devices: readonly DeviceHealth[] }) {
  if (devices.length === 0)
    return (
      <EmptyState title="No devices" icon={<IconPlugConnected size={22} />}>
        <Button size="sm" variant="default" component={Link} href="/connections">
          Add a connection
        </Button>
      </EmptyState>
    );
  return (
    <Table.ScrollContainer minWidth={860} scrollAreaProps={{ viewportProps: { tabIndex: 0, "aria-label": "Devices" } }}>
      <Table className={classes.table} verticalSpacing={5} data-testid="health-devices">
        <Table.Thead>
          <Table.Tr>
            <Table.Th>Device</Table.Th>
            <Table.Th>Link</Table.Th>
            {NUMBERS.map((name) => (
              <Table.Th key={name} className="right">
                {name}
              </Table.Th>
            ))}
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {devices.map((device) => (
            <Row key={device.id} device={device} />
          ))}
        </Table.Tbody>
      </Table>
    </Table.ScrollContainer>
  );
}

function Row({ device }: { device: DeviceHealth }) {
  const { link, queue, telemetry, emulator } = device;
  const figures = [
    fixed(queue.stops + queue.commands + queue.samples),
    queue.longest_wait_ms === 0 ? "none" : duration(queue.longest_wait_ms / 1e3),
    sizeText(link.bytes_sent),
    sizeText(link.bytes_received),
    fixed(link.failures),
    fixed(link.timeouts),
    fixed(telemetry.readers),
    fixed(telemetry.rows_dropped),
  ];
  return (
    <Table.Tr>
      <Table.Td>
        <Group gap={6} wrap="nowrap">
          <StateDot state={device.state} />
          <span>
            <b>{device.name}</b> {device.model}, {device.state}
          </span>
        </Group>
        {device.problem !== null && (
          <Text size="xs" className="fault anywhere">
            {device.problem}
          </Text>
        )}
      </Table.Td>
      <Table.Td>
        {link.kind}
        {emulator !== null && emulator.time_scale !== 1 && `, ${fixed(emulator.time_scale, 1)} times as fast`}
        {emulator !== null && emulator.samples_missed > 0 && `, ${fixed(emulator.samples_missed)} samples missed`}
      </Table.Td>
      {figures.map((figure, index) => (
        <Table.Td key={NUMBERS[index]} className="right">
          {figure}
        </Table.Td>
      ))}
    </Table.Tr>
  );
}
