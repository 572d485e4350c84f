import type { Schemas } from "../../api/client";

type Seen = Pick<Schemas["AxisStateOut"], "flags" | "condition">;

/** A driver's flag of a coil without current, as the families call it. */
const OPEN = /^(driver_)?(ol|open_load_)([ab])$/i;
const MOSTLY = 0.5;

export interface Finding {
  /** what was found, or that nothing tells */
  found: string;
  help: readonly string[];
}

const BY_HAND = [
  "the driver's supply is on, and its enable input is at the level that switches it on",
  "the motor's plug is in: between the two wires of a coil are some ohms, between the coils none",
  "both wires of a coil are side by side at the driver, not crossed with the other's",
  "nothing holds the shaft: uncouple the load, and try once more",
];

/** Why a motor does not turn, by what its driver told while it should. `seen` are readings, the newest last. */
export function whyNoTurn(seen: readonly Seen[]): Finding {
  const condition = seen.at(-1)?.condition;
  if (condition && ["cannot_move", "driver_fault", "not_connected", "held"].includes(condition.kind))
    return { found: condition.cause, help: [] };
  const coils = new Map<string, number>();
  for (const { flags } of seen)
    for (const [name, set] of Object.entries(flags)) {
      const coil = OPEN.exec(name)?.[3]?.toUpperCase();
      if (coil !== undefined) coils.set(coil, (coils.get(coil) ?? 0) + (set ? 1 : 0));
    }
  const open = [...coils].filter(([, count]) => count > MOSTLY * seen.length).map(([coil]) => coil);
  if (open.length > 1)
    return {
      found: "the driver finds no current in coil A, and none in coil B: the motor is not connected",
      help: BY_HAND.slice(0, 2),
    };
  if (open.length === 1)
    return {
      found: `the driver finds no current in coil ${open[0]}: one of its wires is open`,
      help: BY_HAND.slice(1, 2),
    };
  if (coils.size > 0) return { found: "current flows in both coils, as the driver tells", help: BY_HAND.slice(2) };
  return { found: "this device cannot tell whether current flows: look whether", help: BY_HAND };
}
