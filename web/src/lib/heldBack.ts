import type { Device } from "../api/queries";

/** Whether a device answers and its driver leaves it alone all the same: what its user sends by hand still goes out. */
export function isHeldBack(device: Device): boolean {
  return device.state === "failed" && device.axes.some(({ condition }) => condition.kind === "cannot_move");
}
