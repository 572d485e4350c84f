import type { Schemas } from "../../../api/client";
import type { ChipRows } from "../../../lib/rows/useChipRows";
import { heldRamp } from "../output/scales";
import type { Design, Parameter } from "../sramp/design";

export type SequenceQuestion = Schemas["TargetSequence"];
export type SequenceAnswer = Schemas["TargetSequenceResult"];
type Planned = Pick<ChipRows, "planned">;

export type Trigger = "target" | "start";
export type Option = 0 | 1 | 2 | 3;

/** What a set of shadow registers holds by shadow_option. */
const COMMON = ["vmax", "amax", "dmax"] as const;
const BOWS = ["bow1", "bow2", "bow3", "bow4"] as const;
const LINES = ["astart", "dfinal", "vbreak"] as const;
export const SETS: Record<Option, readonly Parameter[]> = {
  0: [...COMMON, ...LINES, "vstart", "vstop", ...BOWS],
  1: [...COMMON, ...BOWS],
  2: [...COMMON, ...LINES, "vstart"],
  3: [...COMMON, ...LINES, "vstop"],
};

export interface Shadow {
  option: Option;
  /** one for option 0, two for the others; what is not in a set is as in the ramp */
  sets: readonly Partial<Design>[];
  cyclic: boolean;
  misses: number;
}

/** A sequence as it is entered. */
export interface Entered {
  targets: readonly number[];
  trigger: Trigger;
  delayS: number;
  /** of pulses at START, for the preview */
  everyS: number;
  ring: boolean;
  shadow: Shadow | null;
}

const PREVIEWED = 12;
export const LONGEST_CLOCKS = 2 ** 32 - 1;

export function mostTargets(trigger: Trigger): number {
  return trigger === "target" ? 9 : 8;
}

/** Shadow sets to begin with: the ramp at half its speed, and the second as it is. */
export function shadowOf(option: Option, ramp: Design): Shadow {
  const of = (design: Design) => Object.fromEntries(SETS[option].map((name) => [name, design[name]]));
  const slow = of({ ...ramp, vmax: ramp.vmax / 2 });
  return { option, sets: option === 0 ? [slow] : [slow, of(ramp)], cyclic: option === 0, misses: 0 };
}

/** What is asked of the calculator; null while the chip holds no ramp or is not known. */
export function questionOf(
  chip: Planned,
  entered: Entered,
  clockHz: number,
  position: number,
): SequenceQuestion | null {
  const held = heldRamp(chip, clockHz);
  if (held === null) return null;
  const { design, options } = held;
  const { shape } = options;
  const pulses = entered.ring ? PREVIEWED : entered.targets.length;
  return {
    position,
    targets: [...entered.targets],
    ramp: { values: { ...design }, shape },
    trigger: entered.trigger,
    shadow: entered.shadow && {
      option: entered.shadow.option,
      sets: entered.shadow.sets.map((values) => ({ values: { ...values } as Record<string, number>, shape })),
      cyclic: entered.shadow.cyclic,
      misses: entered.shadow.misses,
    },
    clock_hz: clockHz,
    direct_acc_val_en: options.directAcceleration,
    direct_bow_val_en: options.directBow,
    use_astart_and_vstart: options.useAstart,
    delay: Math.min(LONGEST_CLOCKS, Math.round(entered.delayS * clockHz)),
    zero_wait: chip.planned("TZEROWAIT") ?? 0,
    pulses_s: entered.trigger === "start" ? Array.from({ length: pulses }, (_, n) => n * entered.everyS) : [],
    immediate: chip.planned("START_CONF", "immediate_start_in") === 1,
    active_high: chip.planned("START_CONF", "pol_start_signal") === 1,
    ring: entered.ring,
    moves_most: PREVIEWED,
    samples: 900,
  };
}

/** Why it cannot be staged now; null where it can. */
export function obstacle(chip: Planned & Pick<ChipRows, "held">): string | null {
  if (chip.planned("RAMPMODE", "OPERATION_MODE") !== 1)
    return "The chip is in velocity mode: a sequence needs positioning, as after a move.";
  if ((chip.held("VACTUAL") ?? 0) !== 0) return "The motor turns: a sequence begins at rest.";
  return null;
}
