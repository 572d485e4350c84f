import { ApiError, api } from "../../../api/client";
import type { AxisAddress } from "../../../api/motion";
import type { Device } from "../../../api/queries";
import { familyOf } from "../../../families/families";

/** Calls the present position zero; the motor does not move. */
export async function setZero({ device, axis }: AxisAddress, of: Device): Promise<void> {
  // Not by the newest sample, which may be older than what the user has seen.
  const { moving } = await api.GET("/api/v1/devices/{device}/axes/{axis}", { path: { device, axis } });
  if (moving)
    throw new ApiError({
      type: "/problems/wrong-state",
      title: "The axis moves",
      status: 409,
      detail: "Zero can only be set while the axis stands still.",
      way_out: "Stop it, then set zero.",
      facts: {},
      remedies: [],
      instance: null,
    });
  const writes = (await familyOf(of)?.zero(of, axis)) ?? [];
  if (writes.length === 0)
    throw new ApiError({
      type: "/problems/wrong-state",
      title: "Zero cannot be set here",
      status: 409,
      detail: `Which registers of ${of.name} hold its position is not known by their names.`,
      way_out: "Write them on the page Registers, as the chip's manual says.",
      facts: {},
      remedies: [],
      instance: null,
    });
  const result = await api.POST("/api/v1/devices/{device}/registers", {
    path: { device },
    body: { writes: writes.map((write) => ({ ...write, axis })) },
  });
  if (result.failed) throw new ApiError(result.failed);
}
