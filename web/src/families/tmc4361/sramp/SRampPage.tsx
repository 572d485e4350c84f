import { useCallback, useMemo } from "react";
import { api, type Schemas } from "../../../api/client";
import { can, type Device, useDevices } from "../../../api/queries";
import { compact } from "../../../lib/format";
import type { Answer } from "../../../lib/ramp/answer";
import { DesignerPage } from "../../../lib/ramp/DesignerPage";
import { DesignPlots, type Ghost, type PlotOf } from "../../../lib/ramp/DesignPlots";
import { motorBody } from "../../../lib/ramp/motor";
import type { Preset } from "../../../lib/ramp/RampRegisters";
import { type RampRules, useDesigner } from "../../../lib/ramp/useDesigner";
import { useHold } from "../../../lib/ramp/useSketch";
import { useFollow } from "../../../lib/useFollow";
import { useSelection } from "../../../live/selection";
import { compared, designOf } from "./chip";
import {
  changed,
  type Design,
  KIND,
  type Lock,
  locked,
  lockOf,
  OPTIONS,
  type Options,
  type Parameter,
  rampParameters,
  START,
  showingDistance,
  used,
  withRoom,
} from "./design";
import { handlesOf, shownHandles } from "./handles";
import { leastOf, Parameters } from "./Parameters";
import { HUES, stretches } from "./phases";
import { corners } from "./rivals";
import { SendSection } from "./SendSection";

const SAMPLES = 800;
const RULES: RampRules<Design, Lock, Options> = {
  name: "sramp",
  groups: ["general", "ramp"],
  kinds: ["velocity", "acceleration", "jerk"],
  fresh: { design: START, more: OPTIONS, lock: "equal", distance: showingDistance(START) },
  changed,
  locked,
  lockOf,
  showingDistance,
  read: (chip, clockHz, { mode }) => {
    const held = designOf(chip, clockHz);
    return held && { design: held.design, more: { ...held.options, mode } };
  },
};
const VELOCITY: PlotOf = { kind: "velocity", height: 190, onPhone: 170 };
const ACCELERATION: PlotOf = { kind: "acceleration", height: 172, onPhone: 160 };
const JERK: PlotOf = { kind: "jerk", height: 188, onPhone: 170 };
const PLOTS: Record<Options["shape"], readonly PlotOf[]> = {
  s: [VELOCITY, ACCELERATION, JERK],
  trapezoid: [VELOCITY, ACCELERATION],
  hold: [VELOCITY],
};
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
  const designer = useDesigner(RULES, device, axis);
  const { sketch, latest, change, onChange, onMore, clockHz, scale, units, way, chip, connected } = designer;
  const { design, distance, more: options } = sketch;
  const onPreset = useCallback(
    (preset: Preset<Design>) => {
      const next = preset.of(latest.current.design);
      const more = withRoom(latest.current.more, next);
      change({ design: next, lock: lockOf(next), more }, `Design ${preset.name}`);
    },
    [change, latest],
  );

  const calculation = useFollow<Schemas["Ramp"], Answer>(
    {
      model: "s_ramp",
      parameters: rampParameters(design, options, clockHz, way),
      distance,
      samples: SAMPLES,
      motor: motorBody(designer.motor, scale),
    },
    (body, signal) => api.POST("/api/v1/calc/ramp", { body, signal }),
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

  const phases = useMemo(() => (answer ? stretches(answer.phases, options.shape) : []), [answer, options.shape]);
  const handles = useMemo(
    () => (answer ? handlesOf(design, shownHandles(used(options), options), phases, answer.duration_s, way) : []),
    [design, options, phases, answer, way],
  );
  // the trapezoid of the same limits lies under the velocity
  const trapezoid = answer?.rivals.find((rival) => rival.name === "trapezoid");
  const ghosts = useMemo((): Ghost[] => {
    if (!trapezoid) return [];
    const { x, y } = corners(trapezoid, way);
    return [{ line: "trapezoid", text: "trapezoid of the same limits", timeS: x, values: { velocity: y } }];
  }, [trapezoid, way]);

  const { held, hold, shown, good } = useHold(sketch, calculation.error === null ? answer : undefined);
  const differences = useMemo(
    () => (good ? compared(good.registers, shown.more, chip) : null),
    [good, shown.more, chip],
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
    <DesignerPage
      title="S-ramp"
      designer={designer}
      answer={answer}
      good={good}
      registers={
        <Parameters
          design={shown.design}
          onChange={onChange}
          onPreset={onPreset}
          lock={sketch.lock}
          onLock={designer.onLock}
          options={options}
          onOptions={onMore}
          units={units}
          scale={scale}
          reach={reach}
          answer={good}
          onRead={designer.onRead}
          reading={connected && designer.readings.isPending}
        />
      }
      send={
        <SendSection
          device={device}
          axis={axis}
          connected={connected}
          chip={chip}
          differences={differences}
          stale={calculation.stale}
          options={shown.more}
          vmax={shown.design.vmax}
          distance={shown.distance}
        />
      }
      plots={
        <DesignPlots
          designer={designer}
          group="sramp"
          calculation={calculation}
          plots={PLOTS[options.shape]}
          stretches={phases}
          hues={HUES}
          handles={handles}
          kinds={KIND}
          onChange={onChange}
          reach={reach}
          mode={options.mode}
          onMode={(mode) => onMore({ mode })}
          peakPps={Math.max(0, ...(answer?.limits ?? []).filter(({ name }) => name === "VMAX").map(({ peak }) => peak))}
          noted={options.mode === "position" && answer ? ` · overshoot ${compact(answer.overshoot_steps)} µsteps` : ""}
          ghosts={ghosts}
          held={held}
          onHold={hold}
        />
      }
      rivals={rivals}
      incomparable={
        options.mode === "velocity"
          ? "In velocity mode there is no move to compare."
          : options.shape !== "s"
            ? "Only S-ramps are compared."
            : null
      }
    />
  );
}

/** The S-ramp of a TMC4361: drawn with handles, calculated as it changes, sent and laid over what the chip does. */
export default function SRampPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  if (devices.isPending) return null;
  const own = can(device, "ramp.s") ? device : undefined;
  return <Designer key={`${own?.id ?? "-"}/${axis}`} device={own} axis={axis} />;
}
