import type { Device } from "../api/queries";

/**
 * Who is served by the same pages. "pmul": chips whose ramps hang on pmul and pdiv (TMC428, TMC4210). "sramp": the
 * TMC4361, with bows, encoder and closed loop. "sixpoint": the TMC5xxx, whose ramps have six points, with the driver on
 * board. "module": parameters instead of registers, and commands.
 */
export type Family = "pmul" | "sramp" | "sixpoint" | "module";

const FAMILIES: Readonly<Record<string, Family>> = {
  tmc428: "pmul",
  tmc4210: "pmul",
  tmc4361: "sramp",
  tmc5031: "sixpoint",
  tmc5062: "sixpoint",
  tmc5072: "sixpoint",
  tmc5130: "sixpoint",
  tmc5160: "sixpoint",
  "pd42-1241": "module",
};

export function familyOf(model: string | undefined): Family | null {
  return model === undefined ? null : (FAMILIES[model] ?? null);
}

/** The models with SixPoint ramps. */
export type SixPointModel = Extract<Device["model"], `tmc5${string}`>;
/** The models with registers. */
export type ChipModel = Exclude<Device["model"], "pd42-1241">;
/** The models whose ramps are designed with pmul and pdiv. */
export type PmulModel = "tmc428" | "tmc4210";

/** The model of a chip whose ramps hang on pmul and pdiv; of any other device, and without one, null. */
export function pmulModel(device: Device | undefined): PmulModel | null {
  return device?.model === "tmc428" || device?.model === "tmc4210" ? device.model : null;
}

/** The model of a chip with SixPoint ramps; of any other device, and without one, null. */
export function sixPointModel(device: Device | undefined): SixPointModel | null {
  return familyOf(device?.model) === "sixpoint" ? (device?.model as SixPointModel) : null;
}

/** Whether there is a third switch besides the two at the ends: a home or reference switch. */
export function hasHomeSwitch(model: Device["model"]): boolean {
  return familyOf(model) !== "sixpoint";
}

export const CHIPS: readonly Family[] = ["pmul", "sramp", "sixpoint"];

/** How people call what belongs to a family: the one they have, and those that a page is for. */
const WORDS: Record<Family, { one: string; many: string; add: string }> = {
  pmul: { one: "a chip that ramps by pmul and pdiv", many: "chips that ramp by pmul and pdiv", add: "a TMC428" },
  sramp: { one: "a chip with S-ramps and an encoder", many: "chips with S-ramps", add: "a TMC4361" },
  sixpoint: { one: "a chip with SixPoint ramps", many: "chips with SixPoint ramps", add: "a TMC5160" },
  module: { one: "a module with parameters", many: "modules with parameters", add: "a module" },
};

export function wordsOf(family: Family): { one: string; add: string } {
  return WORDS[family];
}

/** "chips with registers", "modules with parameters": whom a page of these families is for. */
export function wordsFor(families: readonly Family[]): string {
  if (families.length === CHIPS.length && CHIPS.every((family) => families.includes(family)))
    return "motion controller chips with registers";
  return families.map((family) => WORDS[family].many).join(" and ");
}
