import { Button } from "@mantine/core";
import { IconBookmark, IconX } from "@tabler/icons-react";
import { useCallback, useMemo } from "react";
import { api, type Schemas } from "../../../api/client";
import { can, type Device, useDevices } from "../../../api/queries";
import type { Answer } from "../../../lib/ramp/answer";
import { DesignerPage } from "../../../lib/ramp/DesignerPage";
import { DesignPlots, type Ghost, type Mode, type PlotOf } from "../../../lib/ramp/DesignPlots";
import { motorBody } from "../../../lib/ramp/motor";
import type { Preset } from "../../../lib/ramp/RampRegisters";
import type { TimedRival } from "../../../lib/ramp/TimeBars";
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
  type Parameter,
  rampParameters,
  START,
  showingDistance,
  trapezoidOf,
} from "./design";
import { findingsOn } from "./findings";
import { handlesOf } from "./handles";
import { Parameters } from "./Parameters";
import { HUES, stretches } from "./phases";
import { designOfRaws, REGISTERS, rawsOf, unitOf } from "./registers";
import { SendSection } from "./SendSection";

interface More {
  mode: Mode;
  /** kept aside, to compare with */
  earlier: Design | null;
}

const SAMPLES = 800;
/** Of a rival: it is drawn in straight lines and curves that need no more. */
const RIVAL_SAMPLES = 240;
const RULES: RampRules<Design, Lock, More> = {
  name: "sixpoint",
  groups: ["ramp", "motor"], // of a module its unit mode is in the second
  kinds: ["position", "velocity", "acceleration"],
  fresh: {
    design: START,
    lock: "mirrored",
    distance: showingDistance(START),
    more: { mode: "position", earlier: null },
  },
  changed,
  locked,
  lockOf,
  showingDistance,
  read: (chip, clockHz, more) => {
    const design = designOf(chip, clockHz);
    return design && { design, more };
  },
};
const PLOTS: readonly PlotOf[] = [
  { kind: "velocity", height: 200, onPhone: 180 },
  { kind: "acceleration", height: 190, onPhone: 170 },
  { kind: "position", height: 150, onPhone: 130 },
];
/** Values without which there is no motion may not be 0. */
const NEVER_ZERO: readonly Parameter[] = ["vmax", "amax"];

function useRamp(body: Schemas["Ramp"] | null) {
  return useFollow<Schemas["Ramp"], Answer>(body, (question, signal) =>
    api.POST("/api/v1/calc/ramp", { body: question, signal }),
  );
}

interface Props {
  /** undefined: the designer works without a chip */
  device: Device | undefined;
  axis: number;
}

function ghostOf(line: Ghost["line"], text: string, answer: Answer): Ghost {
  const { time_s: timeS, position, velocity_pps: velocity, acceleration_pps2: acceleration } = answer;
  return { line, text, timeS, values: { position, velocity, acceleration } };
}

function Designer({ device, axis }: Props) {
  const designer = useDesigner(RULES, device, axis);
  const { sketch, latest, take, onChange, onMore, clockHz, scale, units, way, chip, connected } = designer;
  const { design, distance } = sketch;
  const { mode, earlier } = sketch.more;
  const onPreset = useCallback(
    (preset: Preset<Design>) => take(preset.of(latest.current.design), latest.current.more),
    [take, latest],
  );

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
    motor: motorBody(designer.motor, scale),
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
      ...(trapezoidAnswer ? [ghostOf("trapezoid", "trapezoid, V1 = 0", trapezoidAnswer)] : []),
      ...(earlierAnswer ? [ghostOf("earlier", "earlier design", earlierAnswer)] : []),
    ],
    [trapezoidAnswer, earlierAnswer],
  );

  const { held: holds, hold, shown, good } = useHold(sketch, own.error === null ? answer : undefined);
  const raws = useMemo(() => rawsOf(shown.design, clockHz), [shown.design, clockHz]);
  const differences = useMemo(() => compared(raws, chip), [raws, chip]);
  const findings = useMemo(() => findingsOn(shown.design, raws, shown.more.mode, good), [shown, raws, good]);
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

  const phases = useMemo(() => (answer ? stretches(answer.phases, mode) : []), [answer, mode]);
  const handles = useMemo(
    () => (answer ? handlesOf(design, mode, phases, answer.duration_s, way) : []),
    [design, mode, phases, answer, way],
  );

  return (
    <DesignerPage
      title="SixPoint ramp"
      designer={designer}
      answer={answer}
      good={good}
      registers={
        <Parameters
          design={shown.design}
          raws={raws}
          onChange={onChange}
          onPreset={onPreset}
          lock={sketch.lock}
          onLock={designer.onLock}
          units={units}
          scale={scale}
          reach={reach}
          findings={findings}
          onRead={designer.onRead}
          unread={
            connected && chip && !designer.dialect && designer.onRead === null
              ? "The chip does not tell its ramp registers, and nobody here has written all of them yet"
              : ""
          }
          reading={connected && designer.readings.isPending}
        />
      }
      send={
        <SendSection
          device={device}
          axis={axis}
          connected={connected}
          chip={chip}
          dialect={designer.dialect}
          differences={differences}
          mode={shown.more.mode}
          vmax={raws.vmax * unitOf("vmax", clockHz)}
          distance={shown.distance}
        />
      }
      plots={
        <DesignPlots
          designer={designer}
          group="sixpoint"
          calculation={own}
          plots={PLOTS}
          stretches={phases}
          hues={HUES}
          handles={handles}
          kinds={KIND}
          onChange={onChange}
          reach={reach}
          mode={mode}
          onMode={(next) => onMore({ mode: next })}
          peakPps={answer?.velocity_pps.reduce((most, value) => Math.max(most, Math.abs(value)), 0) ?? 0}
          ghosts={ghosts}
          held={holds}
          onHold={hold}
        />
      }
      rivals={rivals}
      incomparable={positioning ? null : "In velocity mode there is no move to compare."}
      comparing={
        <>
          {earlier !== null && (
            <Button
              size="compact-xs"
              variant="default"
              leftSection={<IconX size={12} aria-hidden />}
              onClick={() => onMore({ earlier: null })}
            >
              Forget the earlier
            </Button>
          )}
          <Button
            size="compact-xs"
            variant="default"
            leftSection={<IconBookmark size={12} aria-hidden />}
            disabled={!positioning}
            onClick={() => onMore({ earlier: latest.current.design })}
          >
            Keep to compare
          </Button>
        </>
      }
    />
  );
}

/** The SixPoint ramp of a TMC5xxx: drawn with handles, calculated as the registers hold it, sent and followed live. */
export default function SixPointPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  if (devices.isPending) return null;
  const own = can(device, "ramp.sixpoint") ? device : undefined;
  return <Designer key={`${own?.id ?? "-"}/${axis}`} device={own} axis={axis} />;
}
