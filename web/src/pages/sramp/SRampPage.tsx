import { useSessionStorage } from "@mantine/hooks";
import { useCallback, useEffect, useMemo } from "react";
import { api, type Schemas, unwrap } from "../../api/client";
import { type Device, useDevices } from "../../api/queries";
import { familyOf } from "../../lib/family";
import { ProblemAlert } from "../../lib/ProblemAlert";
import type { Answer } from "../../lib/ramp/answer";
import { LiveMotion } from "../../lib/ramp/LiveMotion";
import { MotorSection } from "../../lib/ramp/MotorSection";
import { MOTOR, type Motor, motorBody } from "../../lib/ramp/motor";
import { channelsOf } from "../../lib/ramp/overlay";
import classes from "../../lib/ramp/ramp.module.css";
import { factor, unitsOf } from "../../lib/ramp/scales";
import { TimeBars } from "../../lib/ramp/TimeBars";
import { useAxisRegisters } from "../../lib/ramp/useAxisRegisters";
import { useFollow } from "../../lib/ramp/useFollow";
import { useLive } from "../../lib/ramp/useLive";
import { useHold, useSketch } from "../../lib/ramp/useSketch";
import { Page } from "../../lib/Section";
import { scaleOf } from "../../lib/units";
import { useSelection } from "../../live/selection";
import { chipRamp, compared, designOf } from "./chip";
import {
  changed,
  type Design,
  type Lock,
  locked,
  lockOf,
  OPTIONS,
  type Options,
  type Parameter,
  type Preset,
  rampParameters,
  START,
  showingDistance,
  withRoom,
} from "./design";
import { leastOf, Parameters } from "./Parameters";
import { SendSection } from "./SendSection";
import { SRampPlots } from "./SRampPlots";

interface Sketch {
  design: Design;
  options: Options;
  lock: Lock;
  distance: number;
}

const SAMPLES = 800;
const FRESH: Sketch = { design: START, options: OPTIONS, lock: "equal", distance: showingDistance(START) };

const GROUPS = ["general", "ramp"];
const LIVE = ["velocity", "acceleration"] as const;
const KINDS = ["velocity", "acceleration", "jerk"] as const;
const NAMES: Record<string, string> = {
  trapezoid: "trapezoid, same limits",
  motor_trapezoid: "trapezoid the motor can follow",
  motor_limit: "what the motor could do",
};

interface Props {
  /** undefined: the designer works without a chip */
  device: Device | undefined;
  axis: number;
}

function Designer({ device, axis }: Props) {
  const clockHz = device?.clock_hz ?? 16e6;
  const info = device?.axes[axis];
  const { connected, readings } = useAxisRegisters(device, axis, GROUPS);
  const told = useMemo(() => (readings.data ? chipRamp(readings.data) : null), [readings.data]);
  const chip = connected ? told : null;
  const { sketch, latest, change, isFresh } = useSketch<Sketch>(`stepscope.sramp.${device?.id ?? "-"}.${axis}`, FRESH);
  const [unitKey, setUnits] = useSessionStorage({
    key: "stepscope.sramp.units",
    defaultValue: "pps",
    getInitialValueInEffect: false,
  });
  const [motor, setMotor] = useSessionStorage<Motor>({
    key: `stepscope.sramp.motor.${device?.id ?? "-"}.${axis}`,
    defaultValue: MOTOR,
    getInitialValueInEffect: false,
  });
  const onMotor = useCallback((part: Partial<Motor>) => setMotor((before) => ({ ...before, ...part })), [setMotor]);
  const { design, options, distance } = sketch;
  const onChange = useCallback(
    (parameter: Parameter, value: number) =>
      change({ design: changed(latest.current.design, parameter, value, latest.current.lock) }),
    [change, latest],
  );

  const onOptions = useCallback(
    (part: Partial<Options>) => change({ options: { ...latest.current.options, ...part } }),
    [change, latest],
  );
  const onLock = useCallback(
    (next: Lock) => change({ lock: next, design: locked(latest.current.design, next) }),
    [change, latest],
  );
  const onPreset = useCallback(
    (preset: Preset) => {
      const next = preset.of(latest.current.design);
      change({ design: next, lock: lockOf(next), options: withRoom(latest.current.options, next) });
    },
    [change, latest],
  );

  const held = useMemo(() => (chip ? designOf(chip, clockHz) : null), [chip, clockHz]);
  const read = useCallback(() => {
    if (held === null) return;
    change({
      design: held.design,
      options: { ...held.options, mode: latest.current.options.mode },
      lock: lockOf(held.design),
      distance: Math.sign(latest.current.distance || 1) * showingDistance(held.design),
    });
  }, [held, change, latest]);
  // The first look at a chip is its own setting, unless it has never been set: then there is nothing to start from.
  // biome-ignore lint/correctness/useExhaustiveDependencies: once, when the chip is known and nothing was kept
  useEffect(() => {
    if (isFresh && held !== null) read();
  }, [held === null]);

  const scale = useMemo(
    () => ({ ...scaleOf(info, clockHz), ...(device ? {} : { microstepsPerFullStep: 256 }) }),
    [info, clockHz, device],
  );
  const units = useMemo(() => unitsOf(unitKey, scale), [unitKey, scale]);
  const way = distance < 0 ? -1 : 1;

  const calculation = useFollow<Schemas["Ramp"], Answer>(
    {
      model: "s_ramp",
      parameters: rampParameters(design, options, clockHz, way),
      distance,
      samples: SAMPLES,
      motor: motorBody(motor, scale),
    },
    async (body, signal) => unwrap(await api.POST("/api/v1/calc/ramp", { body, signal })),
  );
  const answer = calculation.result;
  // by content: the limits change with the units alone, and not with every answer
  const limits = JSON.stringify(answer?.registers.map(({ parameter, least, highest }) => [parameter, least, highest]));
  const reach = useMemo(() => {
    const known = new Map<string, [number, number]>(
      (JSON.parse(limits ?? "[]") as [string, number, number][]).map(([name, least, highest]) => [
        name,
        [least, highest],
      ]),
    );
    return (parameter: Parameter) => {
      const [step, most] = known.get(parameter) ?? [1, 2 ** 23];
      return { least: leastOf(parameter, step), most, step };
    };
  }, [limits]);

  const { plots, drawing, live, seen, setSeen } = useLive(KINDS);
  const factors = useMemo(
    () => ({ velocity: factor("velocity", units, scale), acceleration: factor("acceleration", units, scale) }),
    [units, scale],
  );

  const { held: holds, hold, shown, good } = useHold(sketch, calculation.error === null ? answer : undefined);
  const differences = useMemo(
    () => (good ? compared(good.registers, shown.options, chip) : null),
    [good, shown.options, chip],
  );

  const rivals = useMemo(
    () =>
      (good?.rivals ?? []).map(({ name, text, duration_s }) => ({
        key: name,
        name: NAMES[name] ?? name,
        text,
        seconds: duration_s,
      })),
    [good],
  );

  return (
    <Page name="S-ramp">
      {readings.isError && connected && (
        <ProblemAlert error={readings.error} doing={`Reading ${device?.name}`} retry={() => void readings.refetch()} />
      )}
      {device && connected && channelsOf(device, axis, LIVE).length > 0 && (
        <LiveMotion
          device={device}
          axis={axis}
          way={way}
          endS={answer?.time_s.at(-1) ?? 1}
          factors={factors}
          plots={plots}
          drawing={drawing}
          onSeen={setSeen}
        />
      )}
      <div className={classes.page}>
        <div className={classes.left}>
          <Parameters
            design={shown.design}
            onChange={onChange}
            onPreset={onPreset}
            lock={sketch.lock}
            onLock={onLock}
            options={options}
            onOptions={onOptions}
            units={units}
            scale={scale}
            reach={reach}
            answer={good}
            onRead={held === null ? null : read}
            reading={connected && readings.isPending}
          />
          <SendSection
            device={device}
            axis={axis}
            connected={connected}
            chip={chip}
            differences={differences}
            options={shown.options}
            vmax={shown.design.vmax}
            distance={shown.distance}
          />
        </div>
        <div className={classes.right}>
          <SRampPlots
            calculation={calculation}
            design={design}
            options={options}
            onOptions={onOptions}
            distance={distance}
            onDistance={(steps) => change({ distance: steps })}
            onChange={onChange}
            reach={reach}
            scale={scale}
            units={units}
            onUnits={setUnits}
            live={live}
            plots={plots}
            held={holds}
            onHold={hold}
            seen={seen}
          />
          <TimeBars
            seconds={good?.duration_s ?? null}
            rivals={rivals}
            why={
              options.mode === "velocity"
                ? "In velocity mode there is no move to compare."
                : options.shape !== "s"
                  ? "Only S-ramps are compared."
                  : null
            }
          />
          <MotorSection
            motor={motor}
            onMotor={onMotor}
            answer={good}
            perVelocity={factors.velocity}
            velocityUnit={units.velocity}
          />
        </div>
      </div>
    </Page>
  );
}

/** The S-ramp of a TMC4361: drawn with handles, calculated as it changes, sent and laid over what the chip does. */
export default function SRampPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  if (devices.isPending) return null;
  const own = familyOf(device?.model) === "sramp" ? device : undefined;
  return <Designer key={`${own?.id ?? "-"}/${axis}`} device={own} axis={axis} />;
}
