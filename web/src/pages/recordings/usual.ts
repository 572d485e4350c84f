import { can, type Device } from "../../api/queries";

const USUAL = [
  "position",
  "predicted_position",
  "target_position",
  "velocity",
  "acceleration",
  "encoder_position",
  "deviation",
  "residual",
  "load_value",
];
/** On a module's wire every channel costs a question a sample. */
const SPARING_HZ = 500;
const SPARING = ["position", "velocity", "encoder_position", "deviation"];

/** What is worth recording of an axis: its motion, planned and measured, as far as the device tells it; and `further`. */
export function usualChannels(device: Device, axis: number, further: readonly string[] = []): string[] {
  const offered = new Set(device.channels.map(({ name }) => name));
  const wanted = device.rate_max_hz < SPARING_HZ || can(device, "parameters") ? SPARING : USUAL;
  return [...wanted, ...further].map((quantity) => `${quantity}.${axis}`).filter((name) => offered.has(name));
}
