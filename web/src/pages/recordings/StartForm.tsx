import { Button, Group, MultiSelect, Select, Stack, Text, Textarea, TextInput } from "@mantine/core";
import { useState } from "react";
import { type Device, useDevices } from "../../api/queries";
import { namesOf, optionsOf } from "../../lib/choices";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { symbolOf } from "../../lib/units";
import { useSelection } from "../../live/selection";
import { type Start, useChanges } from "./api";
import { usualChannels } from "./usual";

const RATES_HZ = [10, 50, 100, 200, 500, 1000];

interface Props {
  onStarted: (id: string) => void;
}

/** What to record, how fast, from when on, and for how long. */
export function StartForm({ onStarted }: Props) {
  const devices = useDevices();
  const selection = useSelection();
  const [id, setId] = useState<string | null>(null);
  const device = devices.data?.find((candidate) => candidate.id === id) ?? selection.device;
  if (device === undefined) return <Text size="sm">There is no device to record yet: add one under Connections.</Text>;
  return (
    <Fields
      key={device.id}
      device={device}
      devices={devices.data ?? []}
      axis={device.id === selection.device?.id ? selection.axis : 0}
      onDevice={setId}
      onStarted={onStarted}
    />
  );
}

interface FieldsProps extends Props {
  device: Device;
  devices: readonly Device[];
  axis: number;
  onDevice: (id: string) => void;
}

function Fields({ device, devices, axis, onDevice, onStarted }: FieldsProps) {
  const names = namesOf(devices);
  const changes = useChanges();
  const [name, setName] = useState("");
  const [note, setNote] = useState("");
  const [channels, setChannels] = useState(() => usualChannels(device, axis));
  const [rate, setRate] = useState(() => String(Math.min(500, device.rate_max_hz)));
  const [kind, setKind] = useState<"now" | "move" | "level">("now");
  const [moved, setMoved] = useState(String(axis));
  const [channel, setChannel] = useState<string | null>(null);
  const [level, setLevel] = useState(0);
  const [rising, setRising] = useState("up");
  const [before, setBefore] = useState(0.5);
  const [seconds, setSeconds] = useState<number | null>(null);
  const [wrong, setWrong] = useState<Record<string, boolean>>({});
  const refused = (name: string) => (is: boolean) => setWrong((old) => ({ ...old, [name]: is }));
  const asked = { now: ["duration"], move: ["duration", "before"], level: ["duration", "before", "level"] }[kind];
  const [problem, setProblem] = useState<unknown>(null);
  const [busy, setBusy] = useState(false);

  const crossing = channel !== null && channels.includes(channel) ? channel : (channels[0] ?? null);
  const rates = [...new Set([...RATES_HZ.filter((each) => each <= device.rate_max_hz), device.rate_max_hz])];

  function body(): Start {
    const trigger: Start["trigger"] =
      kind === "move"
        ? { kind, axis: Number(moved), pre_s: before }
        : kind === "level"
          ? { kind, channel: crossing ?? "", level, rising: rising === "up", pre_s: before }
          : { kind };
    return {
      device: device.id,
      channels,
      rate_hz: Number(rate),
      duration_s: seconds,
      trigger,
      name: name.trim(),
      note,
    };
  }

  async function start() {
    setBusy(true);
    setProblem(null);
    try {
      onStarted((await changes.start(body())).id);
    } catch (error) {
      setProblem(error);
    }
    setBusy(false);
  }

  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        void start();
      }}
    >
      <Stack gap="sm">
        <TextInput
          size="sm"
          label="Name"
          data-autofocus
          maxLength={100}
          value={name}
          onChange={(event) => setName(event.currentTarget.value)}
        />
        <Select
          size="sm"
          label="Device"
          data={devices.map((each) => ({ value: each.id, label: names.get(each.id) ?? each.id }))}
          value={device.id}
          onChange={(value) => value && onDevice(value)}
        />
        <MultiSelect
          size="sm"
          label="Channels"
          data={device.channels.map((each) => ({
            value: each.name,
            label: each.unit ? `${each.name} [${symbolOf(each.unit)}]` : each.name,
          }))}
          value={channels}
          onChange={setChannels}
          searchable
          hidePickedOptions
          maxDropdownHeight={260}
          error={channels.length === 0 ? "At least one channel" : undefined}
        />
        <Group grow align="flex-start">
          <Select
            size="sm"
            label="Rate"
            data={rates.map((each) => ({ value: String(each), label: `${each} Hz` }))}
            value={rate}
            onChange={(value) => value && setRate(value)}
          />
          <NumberField
            size="sm"
            label="Duration"
            placeholder="until it is ended"
            unit="s"
            min={0.1}
            max={86_400}
            value={seconds}
            onChange={setSeconds}
            onClear={() => setSeconds(null)}
            onWrong={refused("duration")}
          />
        </Group>
        <Select
          size="sm"
          label="Begins"
          data={optionsOf({
            now: "at once",
            move: "when an axis is sent somewhere",
            level: "when a channel crosses a level",
          })}
          value={kind}
          onChange={(value) => value && setKind(value as typeof kind)}
        />
        {kind === "move" && (
          <Select
            size="sm"
            label="Axis"
            data={device.axes.map((each) => ({ value: String(each.index), label: each.name }))}
            value={moved}
            onChange={(value) => value && setMoved(value)}
          />
        )}
        {kind === "level" && (
          <>
            <Select size="sm" label="Channel that triggers" data={channels} value={crossing} onChange={setChannel} />
            <Group grow align="flex-start">
              <NumberField size="sm" label="Level" value={level} onChange={setLevel} onWrong={refused("level")} />
              <Select
                size="sm"
                label="Direction"
                data={optionsOf({ up: "upwards", down: "downwards" })}
                value={rising}
                onChange={(value) => value && setRising(value)}
              />
            </Group>
          </>
        )}
        {kind !== "now" && (
          <NumberField
            size="sm"
            label="Kept of before the trigger"
            unit="s"
            min={0}
            max={60}
            step={0.1}
            value={before}
            onChange={setBefore}
            onWrong={refused("before")}
          />
        )}
        <Textarea
          label="Note"
          autosize
          minRows={2}
          maxRows={6}
          maxLength={4000}
          value={note}
          onChange={(event) => setNote(event.currentTarget.value)}
        />
        <ProblemAlert error={problem} doing="Recording" onClose={() => setProblem(null)} />
        <Button
          size="sm"
          type="submit"
          loading={busy}
          disabled={channels.length === 0 || asked.some((name) => wrong[name])}
        >
          Start recording
        </Button>
      </Stack>
    </form>
  );
}
