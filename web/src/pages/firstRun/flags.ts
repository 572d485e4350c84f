import type { Schemas } from "../../api/client";

type Reading = Pick<Schemas["RegisterReading"], "name" | "value" | "fields">;

export interface Flag {
  register: string;
  /** null: the register, or parameter, is the flag itself */
  field: string | null;
  value: number;
  other: number;
}

/** Turns a motor round, where a chip or module has it. */
export const REVERSING = ["shaft", "reverse_motor_dir", "inv_dir", "reverse_shaft", "reverse_shaft_direction"];
/** Lets left and right switch change places. */
export const SWAPPING = ["swap_lr", "swap_limit_switches"];

/** Fields that do nothing unless one beside them is 1: the level of an output that is switched off. */
const ONLY_WITH: Record<string, string> = { inv_dir: "en_sd" };

/** The first flag by one of these names, among what a device holds; null where there is none. */
export function flagAmong(rows: readonly Reading[], names: readonly string[]): Flag | null {
  for (const { name, value, fields } of rows) {
    if (names.includes(name)) return { register: name, field: null, value, other: value ? 0 : 1 };
    for (const [field, held] of Object.entries(fields)) {
      const beside = ONLY_WITH[field];
      if (!names.includes(field) || (beside !== undefined && fields[beside] !== 1)) continue;
      return { register: name, field, value: held, other: held ? 0 : 1 };
    }
  }
  return null;
}
