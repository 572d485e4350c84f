import { useEffect, useMemo, useState } from "react";
import { api, type Schemas } from "../../../api/client";
import { type Device, useDevices } from "../../../api/queries";
import { enter } from "../../../lib/history/history";
import { Page } from "../../../lib/Page";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { useAxisRegisters } from "../../../lib/ramp/useAxisRegisters";
import { type AxisScale, scaleOf } from "../../../lib/units";
import { useCalc } from "../../../lib/useCalc";
import { useSessionKept } from "../../../lib/useKept";
import { useSelection } from "../../../live/selection";
import { CurrentScales } from "../currents/CurrentScales";
import {
  compared,
  fromReadings,
  idealP,
  type Model,
  modelOf,
  type Pair,
  pairNear,
  type RampDesign,
  type RampMode,
  rampParameters,
  START,
  showingDistance,
} from "./design";
import { EffectOfP, type Variant } from "./EffectOfP";
import { Inverse } from "./Inverse";
import { PairSection } from "./PairSection";
import { Parameters } from "./Parameters";
import { RampPlots } from "./RampPlots";
import { SendSection } from "./SendSection";
import { StartStop } from "./StartStop";

interface Sketch {
  design: RampDesign;
  reduction: number | null;
  /** a pair chosen by hand; it counts only for the p that it was chosen for */
  own: { pair: Pair; p: number } | null;
  mode: RampMode;
  distance: number;
}

interface Props {
  device: Device | undefined;
  axis: number;
}

function useChipRamp(device: Device | undefined, axis: number) {
  const { connected, readings } = useAxisRegisters(device, axis);
  const model = modelOf(device) ?? "tmc428";
  const chip = useMemo(() => (readings.data ? fromReadings(model, readings.data) : null), [model, readings.data]);
  return { connected, readings, chip: connected ? chip : null };
}

function useRamp(model: Model, body: { parameters: Record<string, number | string>; distance: number } | null) {
  return useCalc<Schemas["Ramp"], Schemas["RampResult"]>(
    "ramp",
    body === null ? null : { model, samples: 1600, ...body },
    (question, signal) => api.POST("/api/v1/calc/ramp", { body: question, signal }),
  );
}

/** What of a sketch a change is about, for people. */
function changedOf(design: RampDesign, part: Partial<Sketch>): string {
  const next = part.design;
  const names = next ? (Object.keys(next) as (keyof RampDesign)[]).filter((name) => next[name] !== design[name]) : [];
  return (names.length > 0 ? names : Object.keys(part)).join(", ");
}

function Designer({ device, axis }: Props) {
  const model: Model = modelOf(device) ?? "tmc428";
  const clockHz = device?.clock_hz ?? 16e6;
  const info = device?.axes[axis];
  const { connected, readings, chip } = useChipRamp(device, axis);

  const [kept, setSketch] = useSessionKept<Sketch | null>(`stepscope.ramps.${device?.id ?? "-"}.${axis}`, null);
  const [units, setUnits] = useSessionKept("stepscope.ramps.units", { velocity: "rpm", acceleration: "pps2" });

  const fallback = useMemo<Sketch>(() => {
    const design = model === "tmc4210" ? { ...START, usrs: null } : START;
    return { design, reduction: null, own: null, mode: "ramp", distance: showingDistance(design) };
  }, [model]);
  const sketch = kept ?? fallback;
  const { design, mode, distance } = sketch;
  const change = (part: Partial<Sketch>, what = changedOf(design, part)) => {
    const label = `Design ${info?.name ?? "a ramp"}: ${what}`;
    enter({ put: setSketch, before: sketch, next: { ...sketch, ...part } }, { label, of: "ramps", merge: label });
  };

  function asHeld(): Sketch | null {
    if (chip === null) return null;
    return {
      ...sketch,
      design: chip.design,
      own: { pair: chip.pair, p: idealP(chip.design) },
      mode: chip.mode === 1 ? "soft" : sketch.mode,
      distance: chip.design.a_max > 0 && chip.design.v_max > 0 ? showingDistance(chip.design) : sketch.distance,
    };
  }
  function read() {
    const held = asHeld();
    if (held) change(held, "as the chip has it");
  }
  // The first look at a chip is its own setting, unless it has never been set: then there is nothing to start from.
  // biome-ignore lint/correctness/useExhaustiveDependencies: once, when the chip is known and nothing was kept
  useEffect(() => {
    if (kept === null && chip !== null && chip.design.v_max > 0 && chip.design.a_max > 0) setSketch(asHeld());
  }, [chip === null]);

  const scale = useMemo<AxisScale>(
    () => ({
      ...scaleOf(info, clockHz),
      microstepsPerFullStep: design.usrs === null ? (info?.driver_microsteps ?? 16) : 2 ** design.usrs,
      pulseDiv: design.pulse_div,
      rampDiv: design.ramp_div,
    }),
    [info, clockHz, design.usrs, design.pulse_div, design.ramp_div],
  );
  const mechanics: Schemas["Mechanics"] = {
    full_steps_per_rev: scale.fullStepsPerRev,
    microsteps_per_full_step: scale.microstepsPerFullStep ?? 64,
    gear_ratio: scale.gearRatio,
    travel_mm_per_rev: scale.travelMmPerRev,
  };

  const pairs = useCalc<Schemas["PmulPdiv"], Schemas["PmulPdivResult"]>(
    "pmul-pdiv",
    {
      chip: model,
      a_max: design.a_max,
      ramp_div: design.ramp_div,
      pulse_div: design.pulse_div,
      reduction: sketch.reduction,
      v_max: design.v_max,
      v_min: design.v_min,
      clock_hz: clockHz,
    },
    (body, signal) => api.POST("/api/v1/calc/pmul-pdiv", { body, signal }),
  );
  const p = idealP(design);
  const own = sketch.own !== null && sketch.own.p === p ? sketch.own.pair : null;
  const answered = pairs.result && pairs.result.p_ideal === p ? pairs.result : null;
  const recommended =
    answered && answered.pmul !== null && answered.pdiv !== null ? { pmul: answered.pmul, pdiv: answered.pdiv } : null;
  const pair = own ?? recommended;
  const noPair = answered !== null && pair === null;

  const asking = (use: Pair | null, reach: number, how: RampMode) =>
    use === null ? null : { parameters: rampParameters(design, use, how, clockHz), distance: reach };
  const whole = useRamp(model, asking(mode === "velocity" ? (pair ?? { pmul: 0, pdiv: 0 }) : pair, distance, mode));

  // The comparison needs no more way than one full speed-up and braking: the more samples fall on the approach.
  const approach = Math.sign(distance || 1) * Math.min(Math.abs(distance) || 1, showingDistance(design));
  const how = mode === "velocity" ? "ramp" : mode;
  const large = pair && pairNear(p * 1.3);
  const small = pair && pairNear(p * 0.6);
  const variants: Variant[] = [
    { id: "chosen", label: "chosen pair", pair, calculation: useRamp(model, asking(pair, approach, how)) },
    {
      id: "large",
      label: "p too large, 1.3 ×",
      pair: large,
      calculation: useRamp(model, asking(large, approach, how)),
    },
    {
      id: "small",
      label: "p too small, 0.6 ×",
      pair: small,
      calculation: useRamp(model, asking(small, approach, how)),
    },
  ];

  const differences = useMemo(
    () => (pair ? compared(model, design, pair, mode, chip) : null),
    [model, design, pair, mode, chip],
  );
  const [limits, setLimits] = useState<{ lower: number; upper: number } | null>(null);
  useEffect(() => {
    if (pairs.result) setLimits({ lower: pairs.result.a_max_lower_limit, upper: pairs.result.a_max_upper_limit });
  }, [pairs.result]);

  return (
    <Page name="Ramps">
      {readings.isError && connected && (
        <ProblemAlert error={readings.error} doing={`Reading ${device?.name}`} retry={() => void readings.refetch()} />
      )}
      <div className="columns design until-75" inert={connected && kept === null && readings.isPending}>
        <div className="column">
          <Parameters
            model={model}
            design={design}
            onChange={(part) => change({ design: { ...design, ...part } })}
            scale={scale}
            driverMicrosteps={info?.driver_microsteps ?? 16}
            units={units}
            onUnits={setUnits}
            limits={limits}
            onRead={chip === null ? null : read}
            reading={connected && readings.isPending}
          />
          <Inverse
            model={model}
            scale={scale}
            design={design}
            mechanics={mechanics}
            reduction={sketch.reduction}
            onUse={(next) => change({ design: next, own: null, distance: showingDistance(next) })}
          />
          <SendSection
            device={device}
            axis={axis}
            connected={connected}
            chip={chip}
            differences={differences}
            noPair={noPair}
            mode={mode}
            vMax={design.v_max}
            distance={distance}
          />
          <StartStop
            own={`${device?.id ?? "-"}.${axis}`}
            ramp={asking(mode === "velocity" ? (pair ?? { pmul: 0, pdiv: 0 }) : pair, distance, mode)}
            scale={scale}
            unit={units.velocity}
            vMin={design.v_min}
            onVMin={(v_min) => change({ design: { ...design, v_min } })}
          />
        </div>
        <div className="column">
          <RampPlots
            calculation={whole}
            impossible={
              noPair && mode !== "velocity"
                ? "No pair of pmul and pdiv represents p, so the chip would not find its target. Change a_max or the dividers."
                : pair === null && mode !== "velocity" && pairs.error !== null
                  ? "The pair of pmul and pdiv could not be calculated, see below."
                  : null
            }
            mode={mode}
            onMode={(next) => change({ mode: next })}
            distance={distance}
            onDistance={(next) => change({ distance: next })}
            scale={scale}
            units={units}
          />
          <PairSection
            model={model}
            design={design}
            calculation={pairs}
            pair={pair}
            byHand={own !== null}
            onPair={(next) => change({ own: next === null ? null : { pair: next, p } })}
            reduction={sketch.reduction}
            onReduction={(reduction) => change({ reduction, own: null })}
          />
          {design.usrs !== null && (
            <CurrentScales
              device={device}
              axis={axis}
              ramp={asking(mode === "velocity" ? (pair ?? { pmul: 0, pdiv: 0 }) : pair, distance, mode)}
              usrs={design.usrs}
            />
          )}
          <EffectOfP variants={variants} noPair={noPair} distance={approach} scale={scale} unit={units.velocity} />
        </div>
      </div>
    </Page>
  );
}

/** Ramps: registers, the pair for p, what the chip will do with them, and the way into the chip. */
export default function RampsPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  if (devices.isPending) return null;
  return <Designer key={`${device?.id ?? "-"}/${axis}`} device={device} axis={axis} />;
}
