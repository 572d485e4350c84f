import { Button, Group, MultiSelect, Table, Text, TextInput } from "@mantine/core";
import { IconPlugConnected, IconX } from "@tabler/icons-react";
import { useState } from "react";
import { Card } from "../../lib/Card";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useWork } from "../../lib/useWork";
import { netText } from "./starts";
import classes from "./together.module.css";
import { useWirePins } from "./useTogether";
import { freePins, keyOf, NET_NAME, type Net, type Pin, pinsWith, pinsWithout, type WirablePin } from "./wires";

interface Props {
  nets: readonly Net[];
  pins: readonly WirablePin[];
  /** of devices, by id */
  names: Readonly<Record<string, string>>;
}

/** Which pins of emulated devices are wired together, and wires to be connected and removed. */
export function WiresCard({ nets, pins, names }: Props) {
  const wire = useWirePins();
  return (
    <Card title="Wires" note="between emulated devices">
      <ProblemAlert error={wire.error} doing="Removing the wire" onClose={wire.reset} />
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
                <Table.Td>
                  <Pins
                    net={net}
                    names={names}
                    busy={wire.isPending}
                    onRemove={(gone) => wire.mutate({ net: net.net, pins: pinsWithout(net, gone) })}
                  />
                </Table.Td>
                <Table.Td className={net.open === null ? "" : "caution"}>{netText(net)}</Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      )}
      {pins.length === 0 ? (
        <Text size="sm" c="dimmed">
          No emulated device has pins to be wired: those of motion controllers with START or step outputs, and of step
          motor drivers, are listed here.
        </Text>
      ) : (
        <Connect nets={nets} pins={pins} names={names} />
      )}
    </Card>
  );
}

interface PinsProps {
  net: Net;
  names: Props["names"];
  busy: boolean;
  onRemove: (pin: Pin) => void;
}

/** The pins of a net, each with a button that takes it off. */
function Pins({ net, names, busy, onRemove }: PinsProps) {
  return (
    <Group gap={6}>
      {net.pins.map((pin) => {
        const title = `${names[pin.device] ?? pin.device} ${pin.pin}`;
        return (
          <Button
            key={keyOf(pin)}
            size="compact-xs"
            variant="default"
            rightSection={<IconX size={12} aria-hidden />}
            aria-label={`Take ${title} off ${net.net}`}
            disabled={busy}
            onClick={() => onRemove(pin)}
          >
            {title}
          </Button>
        );
      })}
    </Group>
  );
}

/** Chosen pins go on a net, of that name or a new one. */
function Connect({ nets, pins, names }: Props) {
  const [name, setName] = useState("");
  const [chosen, setChosen] = useState<string[]>([]);
  const wire = useWirePins();
  const there = nets.find(({ net }) => net === name);
  const wanted = pinsWith(there, chosen, pins);
  const fits = NET_NAME.test(name);
  const connect = useWork(async () => {
    await wire.mutateAsync({ net: name, pins: wanted });
    setChosen([]);
    setName("");
  });
  return (
    <>
      <Group gap="sm" mt="sm" align="flex-start">
        <TextInput
          size="xs"
          label="Net"
          placeholder="start"
          className={classes.net ?? ""}
          value={name}
          error={name === "" || fits ? null : "small letters, digits, dashes"}
          onChange={(event) => setName(event.currentTarget.value)}
        />
        <MultiSelect
          size="xs"
          label="Pins to connect"
          placeholder={chosen.length === 0 ? "choose pins" : ""}
          className={classes.pins ?? ""}
          data={freePins(pins, names)}
          value={chosen}
          onChange={setChosen}
          searchable
          nothingFoundMessage="every pin is on a net"
        />
        <Button
          size="xs"
          mt={22}
          leftSection={<IconPlugConnected size={16} aria-hidden />}
          disabled={!fits || chosen.length === 0 || wanted.length < 2}
          loading={connect.isPending}
          onClick={connect.mutate}
        >
          Connect
        </Button>
      </Group>
      <Text size="xs" c="dimmed" mt={4}>
        START goes with START; a step output with the step inputs of drivers; DIAG of a driver with inputs of stop
        switches. The devices go on meanwhile.
      </Text>
      <ProblemAlert error={connect.error} doing="Connecting the pins" onClose={() => connect.reset()} />
    </>
  );
}
