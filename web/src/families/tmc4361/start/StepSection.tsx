import { Anchor, Button, Text } from "@mantine/core";
import { useState } from "react";
import { Link } from "wouter";
import type { Device } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { compact, fixed, rounded } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { ChipField } from "../../../lib/rows/ChipField";
import type { ChipRows } from "../../../lib/rows/useChipRows";
import { WarningLines } from "../../../lib/Warnings";
import { useChangeEmulator, useEmulator } from "../../../pages/bench/useEmulator";
import { GEAR_ONE, type StepsOut, stepFindings, stepInputOf, stepsOut } from "./start";

const PULSES_MOST = 2 ** 24;
const RATE_MOST = 8e6;

interface Props {
  chip: ChipRows;
  device: Device;
  clockHz: number;
  disabled: boolean;
  microsteps: number | null;
  fullSteps: number;
}

/** Steps at STPIN: how they count, by which ratio they become the chip's own, and what so many come to. */
export function StepSection({ chip, device, clockHz, disabled, microsteps, fullSteps }: Props) {
  const [pulses, setPulses] = useState(1000);
  const [rateHz, setRate] = useState(1000);
  const [wanted, setWanted] = useState<number | null>(null);
  const input = stepInputOf(chip);
  const out = input && stepsOut(input, pulses, rateHz);
  const turn = (microsteps ?? 256) * fullSteps;
  const general = (field: string, label?: string) => (
    <ChipField
      chip={chip}
      register="GENERAL_CONF"
      field={field}
      disabled={disabled}
      {...(label === undefined ? {} : { label })}
    />
  );
  return (
    <Card title="Steps from outside" note="STPIN, DIRIN">
      <div className="halves start gap-8">
        {general("sdin_mode")}
        {general("pol_dir_in")}
        <ChipField
          chip={chip}
          register="GEAR_RATIO"
          physical={(word) => `${rounded(word / GEAR_ONE, 9)} ${word === GEAR_ONE ? "step" : "steps"} a step`}
          disabled={disabled}
        />
        <NumberField
          label="ratio"
          description="staged as GEAR_RATIO"
          inputWrapperOrder={["label", "input", "description", "error"]}
          value={wanted ?? input?.ratio ?? null}
          min={-128}
          max={128 - 1 / GEAR_ONE}
          disabled={disabled}
          onChange={(ratio) => {
            setWanted(null);
            chip.put("GEAR_RATIO", undefined, Math.round(ratio * GEAR_ONE));
          }}
        />
      </div>
      <div className="grid gap-6 my-8">
        {general("sd_indirect_control", "the target moves, and the ramp follows")}
        {general("automatic_direct_sdin_switch_off", "the ramp takes over with VSTART")}
      </div>
      <Text className="hint">
        Which filter STPIN and DIRIN pass is chosen on the page{" "}
        <Anchor component={Link} href="/filters" size="xs" underline="always">
          Input filters
        </Anchor>
        .
      </Text>
      <div className="lines-12 end mt-8">
        <NumberField
          label="Pulses"
          integer
          w={120}
          value={pulses}
          min={-PULSES_MOST}
          max={PULSES_MOST}
          onChange={setPulses}
        />
        <NumberField label="Rate" unit="Hz" w={120} value={rateHz} min={1} max={RATE_MOST} onChange={setRate} />
      </div>
      {input && out && (
        <>
          <Text size="sm" mt={8} data-testid="steps-out">
            <span className="num">{compact(out.steps)}</span> steps come out, {fixed(out.steps / turn, 3)} turns of the
            motor, at <span className="num">{compact(out.pps)}</span> pps.
          </Text>
          <WarningLines texts={stepFindings(input, out.pps, clockHz)} />
          {device.emulated && <Feed device={device} pulses={pulses} rateHz={rateHz} out={out} />}
        </>
      )}
    </Card>
  );
}

interface FeedProps {
  device: Device;
  pulses: number;
  rateHz: number;
  out: StepsOut;
}

/** A pulse generator at the emulated chip, and what its counter made of the pulses. */
function Feed({ device, pulses, rateHz, out }: FeedProps) {
  const emulator = useEmulator(device, true);
  const change = useChangeEmulator(device.id);
  const [from, setFrom] = useState<{ position: number; predicted: number } | null>(null);
  const state = emulator.data;
  if (state === undefined || !("step_output" in state)) return null;
  const feed = () => {
    setFrom({ position: Math.floor(state.ramp.position), predicted: out.steps });
    change.mutate({ step_dir: { pulses, rate_hz: rateHz } });
  };
  return (
    <div className="lines-12 mid mt-8">
      <Button
        size="compact-xs"
        variant="default"
        disabled={pulses === 0}
        loading={change.isPending}
        onClick={feed}
        data-testid="feed"
      >
        Feed the pulses
      </Button>
      {from && (
        <Text size="xs" data-testid="came-out">
          came out: <span className="num">{compact(Math.floor(state.ramp.position) - from.position)}</span> of{" "}
          <span className="num">{compact(from.predicted)}</span> steps
        </Text>
      )}
      {change.isError && <ProblemAlert error={change.error} doing="Feeding pulses" />}
    </div>
  );
}
