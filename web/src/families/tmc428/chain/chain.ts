import type { Schemas } from "../../../api/client";

export type Bit = Schemas["ChainTable"]["bits"][number];
export type ChainTable = Schemas["ChainTable"];

/** Primary signals by code (TMC428 data sheet, Table 11-1). */
export const SIGNALS = [
  "DAC_A_0",
  "DAC_A_1",
  "DAC_A_2",
  "DAC_A_3",
  "DAC_A_4",
  "DAC_A_5",
  "PH_A",
  "FD_A",
  "DAC_B_0",
  "DAC_B_1",
  "DAC_B_2",
  "DAC_B_3",
  "DAC_B_4",
  "DAC_B_5",
  "PH_B",
  "FD_B",
  "Zero",
  "One",
  "Direction",
  "Step",
] as const;

export const KNOWN = ["tmc236", "tmc239", "tmc246", "tmc249", "tmc260", "tmc261", "tmc262", "tmc2660"] as const;
/** Drivers whose mixed-decay bits can follow FD_A and FD_B. */
export const DECAYING: readonly string[] = KNOWN.slice(0, 4);
export const CUSTOM = "custom";
export const DRIVERS_MAX = 3;
export const BITS_MAX = 64;

/** One driver as it is designed here; `signals` and `names` count for a custom one. */
export interface Driver {
  driver: string;
  fastDecay: boolean;
  signals: string[];
  names: string[];
}

export function known(driver: string, fastDecay = false): Driver {
  return { driver, fastDecay, signals: [], names: [] };
}

/** The drivers as the API takes them. */
export function request(drivers: readonly Driver[]): Schemas["DriverSpecIn"][] {
  return drivers.map((driver) =>
    driver.driver === CUSTOM
      ? { driver: CUSTOM, fast_decay: false, signals: driver.signals, bit_names: driver.names }
      : { driver: driver.driver, fast_decay: driver.fastDecay },
  );
}

export type Group = "a" | "b" | "constant" | "motion" | "unused";

/** What a code belongs to: a coil, a constant level, step and direction, or nothing. */
export function groupOf(code: number): Group {
  if (code <= 0x07) return "a";
  if (code <= 0x0f) return "b";
  if (code <= 0x11) return "constant";
  return code <= 0x13 ? "motion" : "unused";
}

/** The bits of each motor, in sending order. */
export function byMotor(bits: readonly Bit[]): Bit[][] {
  const motors: Bit[][] = [];
  for (const bit of bits) {
    const last = motors.at(-1);
    if (last?.[0]?.motor === bit.motor) last.push(bit);
    else motors.push([bit]);
  }
  return motors;
}

const FAMILY = [0x05, 0x04, 0x03, 0x02, 0x06, 0x0d, 0x0c, 0x0b, 0x0a, 0x0e];

/** A driver out of its bits: the TMC236 family where they are its twelve, else custom. RAM does not tell the family apart. */
export function driverOf(bits: readonly Bit[]): Driver {
  const codes = bits.map((bit) => bit.code);
  const coils = [...codes.slice(1, 6), ...codes.slice(7, 12)];
  if (codes.length === 12 && coils.every((code, index) => code === FAMILY[index])) {
    if (codes[0] === 0x10 && codes[6] === 0x10) return known("tmc236", false);
    if (codes[0] === 0x07 && codes[6] === 0x0f) return known("tmc236", true);
  }
  return customOf(bits);
}

export function customOf(bits: readonly Bit[]): Driver {
  return {
    driver: CUSTOM,
    fastDecay: false,
    // the API takes a number for a code without a name, here as text so that all are of one kind
    signals: bits.map((bit) => SIGNALS[bit.code] ?? `0x${bit.code.toString(16)}`),
    names: bits.map((bit) => bit.bit_name),
  };
}

/** The bits with the names that custom drivers bear: the RAM, from which the answer is read, does not hold them. */
export function named(bits: readonly Bit[], drivers: readonly Driver[]): Bit[] {
  return byMotor(bits).flatMap((own, motor) =>
    own.map((bit, index) => {
      const driver = drivers[motor];
      const name = driver?.driver === CUSTOM ? driver.names[index] : undefined;
      return name ? { ...bit, bit_name: name } : bit;
    }),
  );
}

/** The design that a chip's table makes; null where its chain never ends and so has no drivers. */
export function driversOf(table: ChainTable): Driver[] | null {
  const motors = byMotor(table.bits);
  const closed = motors.filter((bits) => bits.at(-1)?.next_motor);
  return closed.length > 0 && closed.length === table.lsmd + 1 ? closed.map(driverOf) : null;
}

function edited(driver: Driver, change: <T>(list: T[], fresh: T) => T[], signal: string): Driver {
  return { ...driver, signals: change(driver.signals, signal), names: change(driver.names, "") };
}

export function insertBit(driver: Driver, at: number, signal: string): Driver {
  return edited(driver, (list, fresh) => [...list.slice(0, at), fresh, ...list.slice(at)], signal);
}

export function removeBit(driver: Driver, at: number): Driver {
  return edited(driver, (list) => list.filter((_, index) => index !== at), "");
}

export function moveBit(driver: Driver, from: number, to: number): Driver {
  if (to < 0 || to >= driver.signals.length) return driver;
  return edited(
    driver,
    (list) => {
      const rest = list.filter((_, index) => index !== from);
      return [...rest.slice(0, to), ...list.slice(from, from + 1), ...rest.slice(to)];
    },
    "",
  );
}

export function setSignal(driver: Driver, at: number, signal: string): Driver {
  return { ...driver, signals: driver.signals.map((old, index) => (index === at ? signal : old)) };
}

/** Positions at which two chains differ; a chain that is longer differs in what it has more. */
export function differing(a: ChainTable, b: ChainTable): Set<number> {
  const positions = new Set<number>();
  const length = Math.max(a.bits.length, b.bits.length);
  for (let position = 0; position < length; position++) {
    if (a.bits[position]?.ram_data !== b.bits[position]?.ram_data) positions.add(position);
  }
  return positions;
}

/** Step pulse of a TMC4210 [s]: 16 * (1 + STPDIV) clocks (register map, STPDIV_4210). */
export function pulseLength(stpdiv: number, clockHz: number): number {
  return (16 * (1 + stpdiv)) / clockHz;
}

/** Fastest step rate at which the pulse and a pause of its length fit [pps]. */
export function stepRateMax(stpdiv: number, clockHz: number): number {
  return 1 / (2 * pulseLength(stpdiv, clockHz));
}
