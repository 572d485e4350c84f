import { type Family, familyOf } from "../../lib/family";

/** The registers that tell of events, by family. */
const REGISTERS: Partial<Record<Family, readonly string[]>> = {
  sramp: ["EVENTS"],
  sixpoint: ["RAMP_STAT", "GSTAT"],
};

/** The registers whose bits are the events of that model; none where it has no timeline. */
export function eventRegisters(model: string | undefined): readonly string[] {
  const family = familyOf(model);
  return (family && REGISTERS[family]) ?? [];
}
