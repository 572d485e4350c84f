import { useSessionStorage } from "@mantine/hooks";
import { useQuery } from "@tanstack/react-query";
import { useCallback, useDeferredValue, useEffect, useMemo, useRef, useState } from "react";
import { api, type Schemas, unwrap } from "../../api/client";
import { type Device, useDevices } from "../../api/queries";
import { familyOf } from "../../lib/family";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { Page } from "../../lib/Section";
import { scaleOf } from "../../lib/units";
import { useSelection } from "../../live/selection";
import type { PlotHandle } from "../../plots/types";
import { chipRamp, compared, designOf } from "./chip";
import {
  type Answer,
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
import { type LiveDrawing, LiveMotion } from "./LiveMotion";
import { MotorSection } from "./MotorSection";
import { MOTOR, type Motor, motorBody } from "./motor";
import { channelsOf } from "./overlay";
import { leastOf, Parameters } from "./Parameters";
import { SendSection } from "./SendSection";
import { type LiveOverlays, type PlotHandles, SRampPlots } from "./SRampPlots";
import { factor, unitsOf } from "./scales";
import classes from "./sramp.module.css";
import { TimeSection } from "./TimeSection";
import { useFollow } from "./useFollow";

interface Sketch {
  design: Design;
  options: Options;
  lock: Lock;
  distance: number;
}

const SAMPLES = 800;
const FRESH: Sketch = { design: START, options: OPTIONS, lock: "equal", distance: showingDistance(START) };

/** The axis' registers, looked at once a second: the design is always compared with what the chip holds now. */
function useChip(device: Device | undefined, axis: number) {
  const connected = device?.state === "connected";
  const id = device?.id ?? "";
  const readings = useQuery({
    queryKey: ["registers", id, axis],
    queryFn: async ({ signal }) =>
      unwrap(
        await api.GET("/api/v1/devices/{device}/registers", {
          params: { path: { device: id }, query: { axis, group: ["general", "ramp"] } },
          signal,
        }),
      ),
    enabled: connected,
    refetchInterval: 1000,
  });
  const chip = useMemo(() => (readings.data ? chipRamp(readings.data) : null), [readings.data]);
  return { connected, readings, chip: connected ? chip : null };
}

interface Props {
  /** undefined: the designer works without a chip */
  device: Device | undefined;
  axis: number;
}

function Designer({ device, axis }: Props) {
  const clockHz = device?.clock_hz ?? 16e6;
  const info = device?.axes[axis];
  const { connected, readings, chip } = useChip(device, axis);
  const [kept, setSketch] = useSessionStorage<Sketch | null>({
    key: `stepscope.sramp.${device?.id ?? "-"}.${axis}`,
    defaultValue: null,
    getInitialValueInEffect: false,
  });
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
  const sketch = kept ?? FRESH;
  const { design, options, distance } = sketch;
  // a handle that is dragged changes the sketch many times between two renderings
  const latest = useRef(sketch);
  latest.current = sketch;
  const change = useCallback(
    (part: Partial<Sketch>) => {
      latest.current = { ...latest.current, ...part };
      setSketch(latest.current);
    },
    [setSketch],
  );
  const onChange = useCallback(
    (parameter: Parameter, value: number) =>
      change({ design: changed(latest.current.design, parameter, value, latest.current.lock) }),
    [change],
  );

  const onOptions = useCallback(
    (part: Partial<Options>) => change({ options: { ...latest.current.options, ...part } }),
    [change],
  );
  const onLock = useCallback(
    (next: Lock) => change({ lock: next, design: locked(latest.current.design, next) }),
    [change],
  );
  const onPreset = useCallback(
    (preset: Preset) => {
      const next = preset.of(latest.current.design);
      change({ design: next, lock: lockOf(next), options: withRoom(latest.current.options, next) });
    },
    [change],
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
  }, [held, change]);
  // The first look at a chip is its own setting, unless it has never been set: then there is nothing to start from.
  // biome-ignore lint/correctness/useExhaustiveDependencies: once, when the chip is known and nothing was kept
  useEffect(() => {
    if (kept === null && held !== null) read();
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

  const velocityPlot = useRef<PlotHandle>(null);
  const accelerationPlot = useRef<PlotHandle>(null);
  const jerkPlot = useRef<PlotHandle>(null);
  const plots = useMemo<PlotHandles>(
    () => ({ velocity: velocityPlot, acceleration: accelerationPlot, jerk: jerkPlot }),
    [],
  );
  const drawing: LiveDrawing = useRef({});
  const live = useMemo<LiveOverlays>(() => {
    const of = (kind: keyof LiveOverlays) => () => drawing.current[kind] ?? [];
    return { velocity: of("velocity"), acceleration: of("acceleration"), jerk: () => [] };
  }, []);
  const [seen, setSeen] = useState(false);
  const factors = useMemo(
    () => ({ velocity: factor("velocity", units, scale), acceleration: factor("acceleration", units, scale) }),
    [units, scale],
  );

  // While a handle is dragged the plots follow at once, and the numbers beside them when there is time.
  const [holds, setHolds] = useState(false);
  const later = useDeferredValue(sketch);
  const shown = holds ? later : sketch;
  const known = calculation.error === null ? answer : undefined;
  const knownLater = useDeferredValue(known);
  const good = holds ? knownLater : known;
  const differences = useMemo(
    () => (good ? compared(good.registers, shown.options, chip) : null),
    [good, shown.options, chip],
  );

  return (
    <Page name="S-ramp">
      {readings.isError && connected && (
        <ProblemAlert error={readings.error} doing={`Reading ${device?.name}`} retry={() => void readings.refetch()} />
      )}
      {device && connected && channelsOf(device, axis).length > 0 && (
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
            onHold={setHolds}
            seen={seen}
          />
          <TimeSection
            answer={good}
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
