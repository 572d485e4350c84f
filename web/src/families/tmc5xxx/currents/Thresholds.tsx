import { Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact, exactText, rounded } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ChipField } from "../../../lib/rows/ChipField";
import { type Registers, THRESHOLDS, thresholdKind } from "./chip";
import classes from "./currents.module.css";
import type { SpeedLimit } from "./figures";
import { SpeedAxis, type Threshold } from "./SpeedAxis";
import { axisFor, ppsOf, registerOf, rpmOf, type SpeedScale } from "./speed";

interface Props {
  chip: Registers;
  scale: SpeedScale;
  /** where the motor's own speed ends */
  limits: readonly SpeedLimit[];
  now: () => number;
  disabled: boolean;
}

const WHAT = {
  stealth: "StealthChop below",
  cool: "CoolStep and StallGuard above",
  high: "fast chopper above",
} as const;

/** TSTEP and the thresholds against it, or the velocities of chips with two axes, as speeds. */
export function Thresholds({ chip, scale, limits, now, disabled }: Props) {
  const kind = thresholdKind(chip);
  const names = THRESHOLDS[kind];
  const axis = axisFor(scale);
  const rows = (["stealth", "cool", "high"] as const).flatMap((role) => {
    const register = names[role];
    return register === null || chip.spot(register) === null ? [] : [{ role, register }];
  });
  const ppsAt = (register: string | null) => (register === null ? null : ppsOf(kind, chip.planned(register), scale));
  const flag = (register: string, field: string) => chip.planned(register, field) === 1;
  const modes = {
    stealth:
      kind === "tstep"
        ? flag("GCONF", "en_pwm_mode") ||
          chip.planned("GCONF", "en_spreadcycle") === 0 ||
          (chip.spot("GCONF", "en_pwm_mode") === null && (chip.planned("PWMCONF", "PWM_GRAD") ?? 0) > 0)
        : (chip.planned("PWMCONF", "PWM_AMPL") ?? 0) > 0,
    stealthBelow: ppsAt(names.stealth),
    coolAbove: ppsAt(names.cool),
    highAbove: ppsAt(names.high),
    highChopper: flag("CHOPCONF", "vhighchm"),
    highFullstep: flag("CHOPCONF", "vhighfs"),
  };
  const thresholds = rows.map(
    ({ role, register }): Threshold => ({
      register,
      name: register,
      pps: ppsAt(register),
      staged: chip.isStaged(register),
      lane: role === "stealth" ? "chopper" : role === "cool" ? "cool" : "both",
    }),
  );
  const move = (register: string, pps: number) => chip.put(register, undefined, registerOf(kind, pps, scale));

  return (
    <Card
      title="Speed thresholds"
      note={kind === "tstep" ? "TSTEP: clocks between two 256ths of a full step" : "velocities of the ramp generator"}
    >
      <SpeedAxis
        axis={axis}
        scale={scale}
        modes={modes}
        thresholds={thresholds}
        limits={limits}
        now={now}
        disabled={disabled}
        onMove={move}
      />
      <div className={classes.thresholdRows}>
        {rows.map(({ role, register }) => {
          const pps = ppsAt(register);
          return (
            <div key={register} className="halves gap-8" data-testid={`threshold-${register}`}>
              <ChipField chip={chip} register={register} disabled={disabled} physical={() => WHAT[role]} />
              <NumberField
                label="as a speed"
                unit="rpm"
                aria-label={`${register} in rpm`}
                value={pps === null ? null : rpmOf(pps, scale)}
                show={(rpm) => exactText(rounded(rpm, 5))}
                placeholder="off"
                min={0}
                max={1e6}
                step={10}
                disabled={disabled}
                description={pps === null ? "0: never" : pps === 0 ? "0: always" : compact(Math.round(pps), 4, "pps")}
                inputWrapperOrder={["label", "input", "description", "error"]}
                onChange={(rpm) => move(register, (rpm * scale.microsteps * scale.fullStepsPerTurn) / 60)}
                data-testid={`rpm-${register}`}
              />
            </div>
          );
        })}
      </div>
      <div className="lines-16 mt-8">
        {kind === "velocity" && (
          <ChipField
            chip={chip}
            register="PWMCONF"
            field="PWM_AMPL"
            label="StealthChop"
            disabled={disabled}
            physical={(value) => (value === 0 ? "0: off" : "on below VCOOLTHRS")}
          />
        )}
        {chip.spot("GCONF", "en_pwm_mode") === null && chip.spot("GCONF", "en_spreadcycle") === null && (
          <ChipField
            chip={chip}
            register="PWMCONF"
            field="PWM_GRAD"
            label="StealthChop"
            disabled={disabled}
            physical={(value) => (value === 0 ? "0: off" : "on below TPWMTHRS")}
          />
        )}
        <ChipField chip={chip} register="GCONF" field="en_pwm_mode" label="StealthChop" disabled={disabled} />
        <ChipField chip={chip} register="GCONF" field="en_spreadcycle" label="SpreadCycle alone" disabled={disabled} />
        <ChipField chip={chip} register="CHOPCONF" field="vhighchm" label="constant off time" disabled={disabled} />
        <ChipField chip={chip} register="CHOPCONF" field="vhighfs" label="full steps" disabled={disabled} />
      </div>
      {modes.highAbove !== null && modes.coolAbove !== null && modes.coolAbove >= modes.highAbove && (
        <Text className="caution text-12" role="status">
          {names.cool} begins where {names.high} has ended it already: CoolStep is never on.
        </Text>
      )}
    </Card>
  );
}
