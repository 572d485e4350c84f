import type { Schemas } from "../../../api/client";
import { useLocalKept } from "../../../lib/useKept";
import type { Registers } from "./chip";
import type { Model } from "./models";

/** How the board measures the coils' current: what no register tells. */
export interface Sensing {
  senseOhm: number;
  /** TMC5130 without sense resistors: between 5VOUT and AIN_IREF; TMC5240: between IREF and ground */
  referenceOhm: number;
  /** TMC5130 with I_scale_analog [V] */
  ainV: number;
}

/** The resistors of the makers' own boards, to begin with. */
const BOARDS: Record<Model, Sensing> = {
  tmc5031: { senseOhm: 0.22, referenceOhm: 9100, ainV: 2.5 },
  tmc5062: { senseOhm: 0.22, referenceOhm: 9100, ainV: 2.5 },
  tmc5072: { senseOhm: 0.22, referenceOhm: 9100, ainV: 2.5 },
  tmc5130: { senseOhm: 0.15, referenceOhm: 9100, ainV: 2.5 },
  tmc5160: { senseOhm: 0.075, referenceOhm: 9100, ainV: 2.5 },
  tmc2130: { senseOhm: 0.11, referenceOhm: 9100, ainV: 2.5 },
  tmc2240: { senseOhm: 0.075, referenceOhm: 12_000, ainV: 2.5 },
  tmc2209: { senseOhm: 0.11, referenceOhm: 9100, ainV: 2.5 },
  tmc5240: { senseOhm: 0.075, referenceOhm: 12_000, ainV: 2.5 },
};

export function useSensing(model: Model, of: string) {
  const [sensing, setSensing] = useLocalKept<Sensing>(`stepscope.currents.sensing.${of}`, BOARDS[model]);
  return [sensing, (part: Partial<Sensing>) => setSensing({ ...sensing, ...part })] as const;
}

export interface CurrentFields {
  internal: boolean;
  analog: boolean;
  scaled: boolean;
  /** full scale is one of several ranges, and nothing but a resistor at IREF is to be known */
  ranged: boolean;
  /** there is a TPOWERDOWN */
  waits: boolean;
}

/** Chips that can measure inside, and whose current a voltage can scale. */
const REFERENCED: readonly Model[] = ["tmc5130", "tmc2130", "tmc2209"];

/** Chips that measure inside, in one of several ranges. */
const RANGED: readonly Model[] = ["tmc5240", "tmc2240"];

/** Which ways of setting a current this chip has, as it is set. */
export function fieldsOf(chip: Registers, model: Model): CurrentFields {
  const internal = REFERENCED.includes(model) && chip.planned("GCONF", "internal_Rsense") === 1;
  return {
    internal,
    analog: REFERENCED.includes(model) && !internal && chip.planned("GCONF", "I_scale_analog") === 1,
    scaled: model === "tmc5160" || RANGED.includes(model),
    ranged: RANGED.includes(model),
    waits: chip.spot("TPOWERDOWN") !== null,
  };
}

export type CurrentBody = Schemas["CoilCurrent"];

/** The question to the server: how the board measures, and what is set. null until the registers are known. */
export function bodyOf(chip: Registers, model: Model, clockHz: number, sensing: Sensing): CurrentBody | null {
  const { internal, analog, scaled, ranged, waits } = fieldsOf(chip, model);
  const irun = chip.planned("IHOLD_IRUN", "IRUN");
  const ihold = chip.planned("IHOLD_IRUN", "IHOLD");
  if (irun === null || ihold === null) return null;
  const scaler = scaled ? chip.planned("GLOBAL_SCALER") : null;
  return {
    model,
    clock_hz: clockHz,
    ...resistors(internal || ranged, analog, sensing),
    ...(ranged ? { current_range: chip.planned("DRV_CONF", "CURRENT_RANGE") } : {}),
    irun,
    ihold,
    ihold_delay: chip.planned("IHOLD_IRUN", "IHOLDDELAY"),
    ...(waits ? { tpowerdown: chip.planned("TPOWERDOWN") } : {}),
    // 1 to 31 are no scaler of this chip: its own answer to them is full scale
    ...(scaled
      ? { global_scaler: scaler === null || scaler < 32 ? 0 : scaler }
      : { vsense: chip.planned("CHOPCONF", "vsense") }),
  };
}

function resistors(internal: boolean, analog: boolean, sensing: Sensing): Partial<CurrentBody> {
  if (internal) return { reference_resistor_ohm: sensing.referenceOhm };
  return { sense_resistor_ohm: sensing.senseOhm, ...(analog ? { ain_v: sensing.ainV } : {}) };
}

/** The same board, asked for the settings of wanted currents. */
export function wantedBody(body: CurrentBody, runA: number, holdA: number, measure: "rms" | "peak"): CurrentBody {
  const { irun: _run, ihold: _hold, vsense: _sense, global_scaler: _scaler, current_range: _range, ...board } = body;
  return { ...board, run_a: runA, hold_a: holdA, measure };
}
