import { Button, Text } from "@mantine/core";
import type { Device } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { duration } from "../../../lib/format";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { ChipField } from "../../../lib/rows/ChipField";
import type { ChipRows } from "../../../lib/rows/useChipRows";
import { WarningLines } from "../../../lib/Warnings";
import { useChangeEmulator, useEmulator } from "../../../pages/bench/useEmulator";
import { StartPicture } from "./StartPicture";
import { PIPED, startOf, TRIGGERS, WAITING } from "./start";
import classes from "./start.module.css";

interface Props {
  chip: ChipRows;
  device: Device;
  clockHz: number;
  disabled: boolean;
}

/** START_CONF as a picture, and its fields. */
export function StartSection({ chip, device, clockHz, disabled }: Props) {
  const start = startOf(chip, clockHz);
  const flag = (field: string, label: string) => (
    <ChipField key={field} chip={chip} register="START_CONF" field={field} label={label} disabled={disabled} />
  );
  const time = (extra: number) => (clocks: number) => duration((clocks + extra) / clockHz);
  return (
    <Card
      title="Start signal"
      note={start ? `START is an ${start.pin}, active ${start.activeHigh ? "high" : "low"}` : ""}
    >
      {start ? (
        // biome-ignore lint/a11y/noNoninteractiveTabindex: on a narrow window the keys scroll it
        <section className={classes.frame} tabIndex={0} aria-label="What triggers what">
          <StartPicture start={start} />
        </section>
      ) : (
        <Text className="hint">Not read yet.</Text>
      )}
      <WarningLines texts={start?.findings ?? []} />
      <div className="halves start gap-8 mt-8">
        <fieldset className="bare grid gap-6">
          <legend className="text-12 bold">A start comes from</legend>
          {TRIGGERS.map((name, n) => flag(`trigger_events[${n}]`, name))}
        </fieldset>
        <fieldset className="bare grid gap-6">
          <legend className="text-12 bold">For it waits</legend>
          {WAITING.map((name, n) => flag(`start_en[${n}]`, name))}
        </fieldset>
        <fieldset className="bare grid gap-6">
          <legend className="text-12 bold">It moves the pipeline into</legend>
          {PIPED.map((name, n) => flag(`pipeline_en[${n}]`, name))}
        </fieldset>
        <fieldset className="bare grid gap-6">
          <legend className="text-12 bold">The pin</legend>
          {flag("immediate_start_in", "without START_DELAY")}
          {flag("busy_state_en", "busy: chips wait for each other")}
          <ChipField chip={chip} register="START_CONF" field="pol_start_signal" label="active" disabled={disabled} />
        </fieldset>
        <ChipField chip={chip} register="START_DELAY" physical={time(0)} disabled={disabled} />
        <ChipField chip={chip} register="START_OUT_ADD" physical={time(1)} disabled={disabled} />
      </div>
      {device.emulated && <EmulatedPin device={device} activeHigh={start?.activeHigh ?? false} />}
    </Card>
  );
}

/** The START pin of an emulated chip: a pulse at it, and how many starts there were. */
function EmulatedPin({ device, activeHigh }: { device: Device; activeHigh: boolean }) {
  const emulator = useEmulator(device, true);
  const change = useChangeEmulator(device.id);
  const state = emulator.data;
  if (state === undefined || !("step_output" in state)) return null;
  const pulse = async () => {
    await change.mutateAsync({ pins: { start: !activeHigh } });
    await change.mutateAsync({ pins: { start: activeHigh } });
    await change.mutateAsync({ pins: { start: "auto" } });
  };
  return (
    <div className="lines-12 mid mt-8">
      <Button
        size="compact-xs"
        variant="default"
        loading={change.isPending}
        onClick={() => void pulse().catch(() => undefined)}
        data-testid="pulse-start"
      >
        Pulse START
      </Button>
      <Text size="xs" data-testid="starts">
        <span className="num">{state.ramp.starts}</span> starts so far
        {state.pins.start_out && ", a pulse goes out now"}
      </Text>
      {change.isError && <ProblemAlert error={change.error} doing="Pulsing START" />}
    </div>
  );
}
