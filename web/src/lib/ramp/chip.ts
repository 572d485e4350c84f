import type { Schemas } from "../../api/client";

/** What is known of an axis' registers, by their names: read, or as last written where they cannot be read. */
export type ChipRamp = ReadonlyMap<string, number>;

/** Packed registers answer by their fields as well. */
export function chipRamp(readings: readonly Schemas["RegisterReading"][]): ChipRamp {
  return new Map(readings.flatMap(({ name, value, fields }) => [[name, value], ...Object.entries(fields)]));
}
