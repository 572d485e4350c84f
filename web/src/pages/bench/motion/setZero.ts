import { ApiError, api, unwrap } from "../../../api/client";
import type { AxisAddress } from "../../../api/motion";
import type { Device } from "../../../api/queries";

/** Each data sheet has its own name for the field. */
const MODE_FIELD: Record<Device["model"], string> = { tmc428: "rm", tmc4210: "RAMP_MODE" };
const RAMP_MODE = 0;
const HOLD_MODE = 3;

/**
 * Calls the present position zero. In RAMP_MODE the motor would run after the difference between the two registers
 * the moment one of them is written: so it is taken out of that mode for the time of both writes.
 */
export async function setZero({ device, axis }: AxisAddress, model: Device["model"], moving: boolean): Promise<void> {
  if (moving)
    throw new ApiError({
      type: "/problems/wrong-state",
      title: "The axis moves",
      status: 409,
      detail: "Zero can only be set while the axis stands still.",
      way_out: "Stop it, then set zero.",
      facts: {},
      instance: null,
    });
  const result = unwrap(
    await api.POST("/api/v1/devices/{device}/registers", {
      params: { path: { device } },
      body: {
        writes: [
          { name: MODE_FIELD[model], axis, value: HOLD_MODE },
          { name: "X_ACTUAL", axis, value: 0 },
          { name: "X_TARGET", axis, value: 0 },
          { name: MODE_FIELD[model], axis, value: RAMP_MODE },
        ],
      },
    }),
  );
  if (result.failed) throw new ApiError(result.failed);
}
