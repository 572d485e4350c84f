import { type AxisAddress, motion } from "../../api/motion";
import type { Device } from "../../api/queries";
import { turnsBy } from "./steps";

/**
 * A turn to either side, slowly, of a motor that can be told so. One without a position turns at a turn a second, and
 * stops by itself after that second, whoever has gone meanwhile.
 */
export async function turn(at: AxisAddress, device: Device, turns: 1 | -1): Promise<unknown> {
  if (turnsBy(device) === "velocity") return await motion.rotate(at, { velocity: turns, unit: "rps", hold_s: 1 });
  return await motion.move(at, { target: turns, relative: true, unit: "rev" });
}
