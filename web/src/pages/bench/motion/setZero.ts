import { ApiError, api, type Schemas, unwrap } from "../../../api/client";
import type { AxisAddress } from "../../../api/motion";
import type { Device } from "../../../api/queries";

type Write = Schemas["RegisterBatchItem"];

const RAMP_MODE = 0;
const HOLD_MODE = 3;

/**
 * In RAMP_MODE the motor would run after the difference between the two registers the moment one of them is written:
 * so it is taken out of that mode for the time of both writes. Each data sheet has its own name for the field.
 */
function ofChip(modeField: string): Write[] {
  return [
    { name: modeField, value: HOLD_MODE },
    { name: "X_ACTUAL", value: 0 },
    { name: "X_TARGET", value: 0 },
    { name: modeField, value: RAMP_MODE },
  ];
}

/**
 * The same for a module: target speed 0 takes it to velocity mode, where no target is followed. The encoder counts
 * along, so it is set too: else the difference would be a deviation, and could stop the motor.
 */
const OF_MODULE: Write[] = [
  { name: "target_speed", value: 0 },
  { name: "actual_position", value: 0 },
  { name: "encoder_position", value: 0 },
];

/**
 * A TMC4361 follows its target while it positions, and turns at VMAX while it does not: with VMAX 0 it does neither.
 * The encoder counts along, but not in a closed loop: there the motor is commutated by what it says.
 */
async function of4361(device: string): Promise<Write[]> {
  const read = async (name: string) =>
    unwrap(await api.GET("/api/v1/devices/{device}/registers/{name}", { params: { path: { device, name } } }));
  const [vmax, encoder] = await Promise.all([read("VMAX"), read("ENC_IN_CONF")]);
  const open = (encoder.fields.regulation_modus ?? 0) === 0;
  return [
    { name: "VMAX", value: 0 },
    { name: "XACTUAL", value: 0 },
    { name: "XTARGET", value: 0 },
    ...(open ? [{ name: "ENC_POS", value: 0 }] : []),
    { name: "VMAX", value: vmax.value },
  ];
}

/** A TMC5xxx in hold mode follows no target. What its encoder counts goes along, where it has one. */
function ofSixPoint(encoder: boolean): Write[] {
  return [
    { name: "RAMPMODE", value: HOLD_MODE },
    { name: "XACTUAL", value: 0 },
    { name: "XTARGET", value: 0 },
    ...(encoder ? [{ name: "X_ENC", value: 0 }] : []),
    { name: "RAMPMODE", value: RAMP_MODE },
  ];
}

const WRITES: Record<Device["model"], (device: string) => Promise<Write[]> | Write[]> = {
  tmc428: () => ofChip("rm"),
  tmc4210: () => ofChip("RAMP_MODE"),
  tmc4361: of4361,
  tmc5031: () => ofSixPoint(false),
  tmc5062: () => ofSixPoint(true),
  tmc5072: () => ofSixPoint(true),
  tmc5130: () => ofSixPoint(true),
  tmc5160: () => ofSixPoint(true),
  "pd42-1241": () => OF_MODULE,
};

/** Calls the present position zero; the motor does not move. */
export async function setZero({ device, axis }: AxisAddress, model: Device["model"], moving: boolean): Promise<void> {
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
  const writes = await WRITES[model](device);
  const result = unwrap(
    await api.POST("/api/v1/devices/{device}/registers", {
      params: { path: { device } },
      body: { writes: writes.map((write) => ({ ...write, axis })) },
    }),
  );
  if (result.failed) throw new ApiError(result.failed);
}
