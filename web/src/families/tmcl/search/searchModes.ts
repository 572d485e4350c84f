import type { SearchStep } from "../../../pages/bench/motion/SearchSteps";

/** Reference search of a PD42-1241 (document FM-PD42-1241 7.1): its modes as words, for AP 193. */
export const MIRRORED = 64;
export const HOME_INVERTED = 128;

export type BaseMode = 1 | 2 | 3 | 4 | 5 | 6 | 7 | 8;

export interface Choice {
  base: BaseMode;
  /** +64, modes 1 to 4: left and right exchanged */
  mirrored: boolean;
  /** +128, modes 5 to 8: the home switch is open where it would be closed */
  inverted: boolean;
}

/** What can be added to a mode; the other switch has no meaning for it. */
export function extraOf(base: BaseMode): "mirrored" | "inverted" {
  return base <= 4 ? "mirrored" : "inverted";
}

export function codeOf({ base, mirrored, inverted }: Choice): number {
  if (extraOf(base) === "mirrored") return base + (mirrored ? MIRRORED : 0);
  return base + (inverted ? HOME_INVERTED : 0);
}

/** The other way; null for a number that is no mode. */
export function choiceOf(code: number): Choice | null {
  const base = code % MIRRORED;
  const extra = code - base;
  if (!(base >= 1 && base <= 8)) return null;
  const wanted = extraOf(base as BaseMode) === "mirrored" ? MIRRORED : HOME_INVERTED;
  if (extra !== 0 && extra !== wanted) return null;
  return { base: base as BaseMode, mirrored: extra === MIRRORED, inverted: extra === HOME_INVERTED };
}

const OTHER = { left: "right", right: "left" } as const;

/** What the motor is going to do, in order. Modes 7 and 8 differ by their direction (TMCL-RS; the manual names one for both). */
export function stepsOf({ base, mirrored }: Choice): SearchStep[] {
  if (base <= 4) {
    const side = mirrored ? "right" : "left";
    const other = OTHER[side];
    const first: SearchStep[] =
      base === 2 || base === 3 ? [{ to: other, fast: true, until: `the ${other} switch closes` }] : [];
    return [
      ...first,
      { to: side, fast: true, until: `the ${side} switch closes` },
      { to: other, fast: false, until: "it opens" },
      { to: side, fast: false, until: "it closes again" },
    ];
  }
  const side = base === 5 || base === 8 ? "left" : "right";
  const turning = base <= 6 ? `; from the ${side} switch it turns round, and goes on mirrored` : "";
  return [
    { to: side, fast: true, until: `the home switch closes${turning}` },
    { to: OTHER[side], fast: false, until: "it opens" },
    { to: side, fast: false, until: "its other edge has passed" },
    { to: OTHER[side], fast: false, until: "it closes again" },
    { to: "zero", fast: false, until: "the middle of both edges" },
  ];
}

/** What of the mode no public source tells; empty where all of it is known. */
export function openOf({ base }: Choice): string {
  if (base === 3 || base === 4)
    return "Manuals say “from both sides”, and not which edges count: the emulated module takes the middle of where the switch opened and closed again.";
  return base >= 7
    ? "The manual names one direction for modes 7 and 8: they differ here as in tables of sister modules. Try it slowly first."
    : "";
}

/** Each mode in a few words. */
export function titleOf({ base, mirrored }: Choice): string {
  const [side, other] = mirrored ? ["right", "left"] : ["left", "right"];
  switch (base) {
    case 1:
      return `${side} switch`;
    case 2:
      return `${other}, then ${side} switch`;
    case 3:
      return `${other}, then middle of ${side} switch`;
    case 4:
      return `middle of ${side} switch`;
    case 5:
      return "home, starting left";
    case 6:
      return "home, starting right";
    case 7:
      return "home to the right, ends ignored";
    default:
      return "home to the left, ends ignored";
  }
}
