import { useState } from "react";
import { api, type Schemas } from "../../../api/client";
import { Card } from "../../../lib/Card";
import { compact, fixed, frequency } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf, lineOf } from "../../../lib/palette";
import { ChipField } from "../../../lib/rows/ChipField";
import type { ChipRows } from "../../../lib/rows/useChipRows";
import { useCalc } from "../../../lib/useCalc";
import { useScheme } from "../../../lib/useScheme";
import { WarningLines } from "../../../lib/Warnings";
import { Plot } from "../../../plots/Plot";
import { pwmOf } from "./scales";

const ask = (body: Schemas["PwmDuty"], signal: AbortSignal): Promise<Schemas["PwmDutyResult"]> =>
  api.POST("/api/v1/calc/pwm-duty", { body, signal });
const SHARE = { unit: "%", range: [0, 100] as const };

interface Props {
  chip: ChipRows;
  clockHz: number;
  disabled: boolean;
}

/** PWM at STPOUT and DIROUT: its frequency, its amplitude over speed, and both duties over the electrical turn. */
export function PwmSection({ chip, clockHz, disabled }: Props) {
  const scheme = useScheme();
  const [speed, setSpeed] = useState(0);
  const { result, stale, error, retry } = useCalc("pwm-duty", pwmOf(chip, clockHz, speed), ask);
  const on = chip.planned("GENERAL_CONF", "pwm_out_en") === 1;
  const percent = (values: readonly number[]) => values.map((value) => value * 100);
  const field = (register: string, name?: string, physical?: (value: number) => string) => (
    <ChipField
      chip={chip}
      register={register}
      disabled={disabled}
      physical={physical}
      {...(name === undefined ? {} : { field: name })}
    />
  );
  return (
    <Card
      title="PWM outputs"
      note={
        result ? `${frequency(result.frequency_hz)}, ${compact(result.steps)} duties${on ? "" : ", off"}` : undefined
      }
    >
      {error !== null && <ProblemAlert error={error} doing="Reckoning the duty" retry={retry} />}
      <div className="halves start gap-8">
        {field("PWM_FREQ", undefined, (clocks) => (clocks ? frequency(clockHz / clocks) : "no PWM"))}
        {field("PWM_VMAX")}
        {field("CURRENT_CONF", "pwm_ampl", (value) => `${fixed(((value + 1) / 2 ** 17) * 100, 1, "%")} at rest`)}
        {field("MSOFFSET", undefined, (value) => `${fixed((value / 1024) * 360, 1)}° electrical`)}
      </div>
      <div className="lines-16 my-8 end">
        {field("GENERAL_CONF", "pwm_out_en")}
        {field("CURRENT_CONF", "pwm_scale_en")}
        <NumberField label="Look at" unit="pps" w={130} value={speed} min={0} max={1.6e7} onChange={setSpeed} />
      </div>
      {result && (
        <div className="fades" data-stale={stale} data-testid="pwm-duty">
          <Plot
            label="Duty over the electrical turn"
            summary={`Duty 50 % plus or minus ${fixed(result.amplitude_there * 100, 1, "%")}`}
            series={[
              { label: "PWM A (STPOUT)", unit: "%", color: colorOf("phase_a", scheme), width: 2 },
              { label: "PWM B (DIROUT)", unit: "%", ...lineOf("phase_b", scheme), width: 2 },
            ]}
            data={[result.place, percent(result.duty_a), percent(result.duty_b)]}
            x={{ label: "place in the microstep table" }}
            scales={{ y: SHARE }}
            height={170}
          />
          <Plot
            label="Amplitude of the duty over speed"
            series={[{ label: "amplitude", unit: "%", color: colorOf("current_scale", scheme), width: 2 }]}
            data={[result.speed_pps, percent(result.amplitude)]}
            x={{ label: "speed", unit: "pps" }}
            scales={{ y: { unit: "%", range: [0, 52] } }}
            marks={[{ id: "speed", x: speed, color: colorOf("position_reached", scheme), fixed: true }]}
            height={130}
          />
          <WarningLines texts={result.findings} />
        </div>
      )}
    </Card>
  );
}
