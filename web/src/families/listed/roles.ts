import { can, type Device } from "../../api/queries";
import type { TopRegister, Write } from "../family";

/** Modes of a ramp generator, by what the names mean on every chip that has them. */
const TO_TARGET = 0;
const HOLD = 3;
const TOP = /^(max_?velocity|max_?positioning_?speed|(\w+_)?vmax(_m\d)?)$/i;

/** The register or parameter of an axis whose whole name fits; undefined where none does. */
function named(device: Device, axis: number, pattern: RegExp): string | undefined {
  return device.channels.find((channel) => channel.axis === axis && pattern.test(channel.quantity))?.quantity;
}

/** The highest velocity that an axis is set to: a number of the device's own, as its velocities are. */
export function topOf(device: Device, axis: number): TopRegister | null {
  const name = named(device, axis, TOP);
  return name === undefined ? null : { name, pps: () => 1 };
}

/** What calls the present position zero: without following a target meanwhile. */
export function zeroOf(device: Device, axis: number): Write[] {
  if (can(device, "parameters"))
    // Target speed 0 takes a module to velocity mode, where no target is followed.
    return [
      { name: "TargetVelocity", value: 0 },
      { name: "ActualPosition", value: 0 },
    ];
  const position = named(device, axis, /^(\w+_)?xactual(_m\d)?$/i);
  const target = named(device, axis, /^(\w+_)?xtarget(_m\d)?$/i);
  const mode = modeOf(device, axis);
  if (position === undefined || target === undefined || mode === null) return [];
  return [mode(HOLD), { name: position, value: 0 }, { name: target, value: 0 }, mode(TO_TARGET)];
}

/** How the mode of an axis is written: a register, or its field of one that all axes share; null where none has it. */
function modeOf(device: Device, axis: number): ((mode: number) => Write) | null {
  const shared = device.channels.find(({ quantity }) =>
    new RegExp(`\\.(\\w+_)?M${axis}_RAMPMODE$`, "i").test(quantity),
  );
  const [register, field] = shared?.quantity.split(".") ?? [];
  if (register !== undefined && field !== undefined) return (mode) => ({ name: register, fields: { [field]: mode } });
  const own = named(device, axis, /^(\w+_)?rampmode(_m\d)?$/i);
  return own === undefined ? null : (mode) => ({ name: own, value: mode });
}
