import { Button } from "@mantine/core";
import { useSessionStorage } from "@mantine/hooks";
import { IconBookmark, IconX } from "@tabler/icons-react";
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
import { TimeBars, type TimedRival } from "../../lib/ramp/TimeBars";
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
  type Mode,
  type Parameter,
  type Preset,
  rampParameters,
  START,
  showingDistance,
  trapezoidOf,
} from "./design";
import { findingsOn } from "./findings";
import { Parameters } from "./Parameters";
import { designOfRaws, REGISTERS, rawsOf, unitOf } from "./registers";
import { SendSection } from "./SendSection";
import { type Ghost, SixPointPlots } from "./SixPointPlots";

interface Sketch {
  design: Design;
  mode: Mode;
  lock: Lock;
  distance: number;
  /** kept aside, to compare with */
  earlier: Design | null;
}

const SAMPLES = 800;
/** Of a rival: it is drawn in straight lines and curves that need no more. */
const RIVAL_SAMPLES = 240;
const FRESH: Sketch = {
  design: START,
  mode: "position",
  lock: "mirrored",
  distance: showingDistance(START),
  earlier: null,
};
const GROUPS = ["ramp"];
const KINDS = ["position", "velocity", "acceleration"] as const;
/** Values without which there is no motion may not be 0. */
const NEVER_ZERO: readonly Parameter[] = ["vmax", "amax"];

function useRamp(body: Schemas["Ramp"] | null) {
  return useFollow<Schemas["Ramp"], Answer>(body, async (question, signal) =>
    unwrap(await api.POST("/api/v1/calc/ramp", { body: question, signal })),
  );
}

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
  const { sketch, latest, change, isFresh } = useSketch<Sketch>(
    `stepscope.sixpoint.${device?.id ?? "-"}.${axis}`,
    FRESH,
  );
  const [unitKey, setUnits] = useSessionStorage({
    key: "stepscope.sixpoint.units",
    defaultValue: "pps",
    getInitialValueInEffect: false,
  });
  const [motor, setMotor] = useSessionStorage<Motor>({
    key: `stepscope.sixpoint.motor.${device?.id ?? "-"}.${axis}`,
    defaultValue: MOTOR,
    getInitialValueInEffect: false,
  });
  const onMotor = useCallback((part: Partial<Motor>) => setMotor((before) => ({ ...before, ...part })), [setMotor]);
  const { design, mode, distance, earlier } = sketch;
  const way = distance < 0 ? -1 : 1;
  const onChange = useCallback(
    (parameter: Parameter, value: number) =>
      change({ design: changed(latest.current.design, parameter, value, latest.current.lock) }),
    [change, latest],
  );
  const onLock = useCallback(
    (lock: Lock) => change({ lock, design: locked(latest.current.design, lock) }),
    [change, latest],
  );
  const take = useCallback(
    (next: Design) =>
      change({
        design: next,
        lock: lockOf(next),
        distance: Math.sign(latest.current.distance || 1) * showingDistance(next),
      }),
    [change, latest],
  );
  const onPreset = useCallback((preset: Preset) => take(preset.of(latest.current.design)), [take, latest]);

  const inChip = useMemo(() => (chip ? designOf(chip, clockHz) : null), [chip, clockHz]);
  const read = useCallback(() => inChip && take(inChip), [inChip, take]);
  // The first look at a chip is its own setting, unless it is not known or has never been set.
  // biome-ignore lint/correctness/useExhaustiveDependencies: once, when the chip is known and nothing was kept
  useEffect(() => {
    if (isFresh) read();
  }, [inChip === null]);

  const scale = useMemo(
    () => ({ ...scaleOf(info, clockHz), ...(device ? {} : { microstepsPerFullStep: 256 }) }),
    [info, clockHz, device],
  );
  const units = useMemo(() => unitsOf(unitKey, scale), [unitKey, scale]);
  const reach = useCallback(
    (parameter: Parameter) => {
      const step = unitOf(parameter, clockHz);
      return { least: NEVER_ZERO.includes(parameter) ? step : 0, most: REGISTERS[parameter].most * step, step };
    },
    [clockHz],
  );

  // What the registers will hold is what is calculated with; what was wished is one of the rivals.
  const held = (wished: Design) => designOfRaws(rawsOf(wished, clockHz), clockHz);
  const asking = (of: Design, samples: number) => ({
    model: "sixpoint" as const,
    parameters: rampParameters(of, mode, way),
    distance,
    samples,
  });
  const positioning = mode === "position";
  const own = useRamp({
    ...asking(held(design), SAMPLES),
    parameters: rampParameters(held(design), mode, way, clockHz),
    motor: motorBody(motor, scale),
  });
  const asTrapezoid = positioning && design.v1 > 0 ? asking(held(trapezoidOf(design)), RIVAL_SAMPLES) : null;
  const trapezoid = useRamp(asTrapezoid);
  const asEarlier = positioning && earlier !== null ? asking(held(earlier), RIVAL_SAMPLES) : null;
  const before = useRamp(asEarlier);
  const wished = useRamp(positioning ? asking(design, 2) : null);
  const answer = own.result;

  const trapezoidAnswer = asTrapezoid && trapezoid.error === null ? trapezoid.result : undefined;
  const earlierAnswer = asEarlier && before.error === null ? before.result : undefined;
  const ghosts = useMemo<Ghost[]>(
    () => [
      ...(trapezoidAnswer ? [{ line: "trapezoid" as const, text: "trapezoid, V1 = 0", answer: trapezoidAnswer }] : []),
      ...(earlierAnswer ? [{ line: "earlier" as const, text: "earlier design", answer: earlierAnswer }] : []),
    ],
    [trapezoidAnswer, earlierAnswer],
  );

  const { plots, drawing, live, seen, setSeen } = useLive(KINDS);
  const factors = useMemo(
    () =>
      Object.fromEntries(KINDS.map((kind) => [kind, factor(kind, units, scale)])) as Record<
        (typeof KINDS)[number],
        number
      >,
    [units, scale],
  );

  const { held: holds, hold, shown, good } = useHold(sketch, own.error === null ? answer : undefined);
  const raws = useMemo(() => rawsOf(shown.design, clockHz), [shown.design, clockHz]);
  const differences = useMemo(() => compared(raws, chip), [raws, chip]);
  const findings = useMemo(() => findingsOn(shown.design, raws, shown.mode, good), [shown, raws, good]);
  const rounding = good && wished.result && !wished.stale ? Math.abs(wished.result.duration_s - good.duration_s) : 0;
  const wishedS = rounding > 5e-4 * (good?.duration_s ?? 0) ? wished.result?.duration_s : undefined;
  const rivals = useMemo<TimedRival[]>(
    () => [
      ...(trapezoidAnswer
        ? [
            {
              key: "trapezoid",
              name: "trapezoid, V1 = 0",
              text: "the same limits without A1 and D1",
              seconds: trapezoidAnswer.duration_s,
            },
          ]
        : []),
      ...(earlierAnswer ? [{ key: "earlier", name: "earlier design", seconds: earlierAnswer.duration_s }] : []),
      ...(wishedS !== undefined
        ? [{ key: "wished", name: "as wished", text: "without the rounding of the registers", seconds: wishedS }]
        : []),
    ],
    [trapezoidAnswer, earlierAnswer, wishedS],
  );

  return (
    <Page name="SixPoint ramp">
      {readings.isError && connected && (
        <ProblemAlert error={readings.error} doing={`Reading ${device?.name}`} retry={() => void readings.refetch()} />
      )}
      {device && connected && channelsOf(device, axis, KINDS).length > 0 && (
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
            raws={raws}
            onChange={onChange}
            onPreset={onPreset}
            lock={sketch.lock}
            onLock={onLock}
            units={units}
            scale={scale}
            reach={reach}
            findings={findings}
            onRead={inChip === null ? null : read}
            unread={
              connected && chip && inChip === null
                ? "The chip does not tell its ramp registers, and nobody here has written all of them yet"
                : ""
            }
            reading={connected && readings.isPending}
          />
          <SendSection
            device={device}
            axis={axis}
            connected={connected}
            chip={chip}
            differences={differences}
            mode={shown.mode}
            vmax={raws.vmax * unitOf("vmax", clockHz)}
            distance={shown.distance}
          />
        </div>
        <div className={classes.right}>
          <SixPointPlots
            calculation={own}
            design={design}
            mode={mode}
            onMode={(next) => change({ mode: next })}
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
            ghosts={ghosts}
          />
          <TimeBars
            seconds={good?.duration_s ?? null}
            rivals={rivals}
            why={positioning ? null : "In velocity mode there is no move to compare."}
            actions={
              <>
                {earlier !== null && (
                  <Button
                    size="compact-xs"
                    variant="default"
                    leftSection={<IconX size={12} aria-hidden />}
                    onClick={() => change({ earlier: null })}
                  >
                    Forget the earlier
                  </Button>
                )}
                <Button
                  size="compact-xs"
                  variant="default"
                  leftSection={<IconBookmark size={12} aria-hidden />}
                  disabled={!positioning}
                  onClick={() => change({ earlier: latest.current.design })}
                >
                  Keep to compare
                </Button>
              </>
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

/** The SixPoint ramp of a TMC5xxx: drawn with handles, calculated as the registers hold it, sent and followed live. */
export default function SixPointPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  if (devices.isPending) return null;
  const own = familyOf(device?.model) === "sixpoint" ? device : undefined;
  return <Designer key={`${own?.id ?? "-"}/${axis}`} device={own} axis={axis} />;
}
