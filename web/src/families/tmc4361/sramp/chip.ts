import type { Answer } from "../../../lib/ramp/answer";
import type { ChipRamp } from "../../../lib/ramp/chip";
import type { Difference } from "../../../lib/ramp/differences";
import type { Design, Options, Shape } from "./design";
import { OPTIONS, START } from "./design";

const SHAPES: Record<Shape, number> = { hold: 0, trapezoid: 1, s: 2 };
const SHAPE_NAMES = ["hold", "trapezoid", "S-ramp"];

export function shownValue(
  row: Pick<Difference, "label">,
  value: number | null,
  fixed: (value: number) => string,
): string {
  if (value === null) return "?";
  if (row.label === "OPERATION_MODE") return value === POSITIONING ? "positioning" : "velocity";
  return row.label === "RAMP_PROFILE" ? (SHAPE_NAMES[value] ?? fixed(value)) : fixed(value);
}

const POSITIONING = 1;

/** The chip stands in velocity mode, as after a reset or a stop: whatever is written to VMAX sets it going. */
export function waits(chip: ChipRamp | null): boolean {
  const zero = (name: string) => chip?.get(name) === 0;
  return zero("OPERATION_MODE") && zero("VMAX") && zero("VACTUAL");
}

/**
 * The design beside the chip, in the order in which it is written: units first, then what shapes the ramp, then what
 * may set it going. While the motor turns only the shape goes into RAMPMODE: whether VMAX is a limit or a velocity is
 * left to the commands that move it, since changing that starts or turns round a motor by itself.
 */
export function compared(registers: Answer["registers"], options: Options, chip: ChipRamp | null): Difference[] {
  const row = (register: string, field: string | null, to: number): Difference => ({
    label: field ?? register,
    register,
    field,
    from: chip?.get(field ?? register) ?? null,
    to,
  });
  // At rest in velocity mode a motor turns as soon as VMAX is written: it is told to hold its place first.
  const place = waits(chip) ? [row("XTARGET", null, chip?.get("XACTUAL") ?? 0)] : [];
  const mode = waits(chip) ? [row("RAMPMODE", "OPERATION_MODE", POSITIONING)] : [];
  const values = registers.filter(({ name }) => name !== "VMAX").map(({ name, raw }) => row(name, null, raw));
  const vmax = registers.filter(({ name }) => name === "VMAX").map(({ name, raw }) => row(name, null, raw));
  return [
    row("GENERAL_CONF", "use_astart_and_vstart", options.useAstart ? 1 : 0),
    row("GENERAL_CONF", "direct_acc_val_en", options.directAcceleration ? 1 : 0),
    row("GENERAL_CONF", "direct_bow_val_en", options.directBow ? 1 : 0),
    ...values,
    ...place,
    row("RAMPMODE", "RAMP_PROFILE", SHAPES[options.shape]),
    ...mode,
    ...vmax,
  ];
}

/** What 1 in a register stands for (DS-TMC4361 8.2.3), to read a design out of the chip. */
function unitsOf(options: Options, clockHz: number): { velocity: number; acceleration: number; bow: number } {
  return {
    velocity: 1 / 256,
    acceleration: options.directAcceleration ? clockHz ** 2 / 2 ** 37 : 1 / 4,
    bow: options.directBow ? clockHz ** 3 / 2 ** 53 : 1,
  };
}

/**
 * The design that the chip holds; null where it has never been set (VMAX or AMAX 0) or is not known. Bows of 0, as of
 * a chip that makes trapezoids, stay at what the designer begins with.
 */
export function designOf(chip: ChipRamp, clockHz: number): { design: Design; options: Options } | null {
  const get = (name: string) => chip.get(name) ?? Number.NaN;
  const options: Options = {
    ...OPTIONS,
    shape: (["hold", "trapezoid", "s"] as const)[get("RAMP_PROFILE")] ?? "s",
    useAstart: get("use_astart_and_vstart") === 1,
    directAcceleration: get("direct_acc_val_en") === 1,
    directBow: get("direct_bow_val_en") === 1,
  };
  const unit = unitsOf(options, clockHz);
  const design: Design = {
    vmax: Math.abs(get("VMAX")) * unit.velocity,
    amax: get("AMAX") * unit.acceleration,
    dmax: get("DMAX") * unit.acceleration,
    bow1: get("BOW1") * unit.bow || START.bow1,
    bow2: get("BOW2") * unit.bow || START.bow2,
    bow3: get("BOW3") * unit.bow || START.bow3,
    bow4: get("BOW4") * unit.bow || START.bow4,
    vstart: get("VSTART") * unit.velocity,
    vstop: get("VSTOP") * unit.velocity,
    vbreak: get("VBREAK") * unit.velocity,
    astart: (get("ASTART") & 0xffffff) * unit.acceleration,
    dfinal: get("DFINAL") * unit.acceleration,
  };
  if (Object.values(design).some((value) => Number.isNaN(value)) || !design.vmax || !design.amax) return null;
  return { design: { ...design, dmax: design.dmax || design.amax }, options };
}
