import { describe, expect, it } from "vitest";
import {
  type Bit,
  byMotor,
  type ChainTable,
  CUSTOM,
  differing,
  driverOf,
  driversOf,
  groupOf,
  insertBit,
  known,
  moveBit,
  named,
  pulseLength,
  removeBit,
  request,
  SIGNALS,
  setSignal,
  stepRateMax,
} from "./chain";

const PLAIN = [0x10, 5, 4, 3, 2, 6, 0x10, 0x0d, 0x0c, 0x0b, 0x0a, 0x0e];
const FAST = [0x07, 5, 4, 3, 2, 6, 0x0f, 0x0d, 0x0c, 0x0b, 0x0a, 0x0e];

/** Bits as the server gives them. */
function bitsOf(...motors: number[][]): Bit[] {
  let address = 0;
  return motors.flatMap((codes, motor) =>
    codes.map((code, index) => {
      const last = index === codes.length - 1;
      const position = address++;
      return {
        position,
        motor,
        signal: SIGNALS[code] ?? "",
        code,
        next_motor: last,
        ram_address: position,
        ram_data: code | (last ? 0x20 : 0),
        bit_name: "",
      };
    }),
  );
}

function table(bits: Bit[], lsmd: number): ChainTable {
  return { bits, ram_words: [], lsmd, length_bits: bits.length, findings: [] };
}

describe("a chain", () => {
  it("is told apart by motors", () => {
    expect(byMotor(bitsOf(PLAIN, FAST)).map((bits) => bits.length)).toEqual([12, 12]);
    expect(byMotor([])).toEqual([]);
  });

  it("knows the TMC236 family by its twelve signals (data sheet, Table 11-2)", () => {
    expect(driverOf(bitsOf(PLAIN))).toEqual(known("tmc236", false));
    expect(driverOf(bitsOf(FAST))).toEqual(known("tmc236", true));
    expect(driverOf(bitsOf(PLAIN.with(1, 4))).driver).toBe(CUSTOM);
    expect(driverOf(bitsOf(PLAIN.slice(0, 11))).driver).toBe(CUSTOM);
  });

  it("becomes a design only where every driver is closed by its NxM", () => {
    expect(driversOf(table(bitsOf(PLAIN, PLAIN, FAST), 2))).toHaveLength(3);
    expect(driversOf(table(bitsOf(PLAIN), 2))).toBeNull();
    const endless = bitsOf(PLAIN).map((bit) => ({ ...bit, next_motor: false }));
    expect(driversOf(table(endless, 0))).toBeNull();
  });

  it("keeps codes without a name", () => {
    expect(driverOf(bitsOf([0x14, 0x11])).signals).toEqual(["0x14", "One"]);
    expect(groupOf(0x14)).toBe("unused");
    expect(SIGNALS.map((_, code) => groupOf(code)).filter((group) => group === "a")).toHaveLength(8);
  });

  it("differs where the RAM differs, and in what one has more", () => {
    const short = table(bitsOf(PLAIN), 0);
    expect(differing(short, short).size).toBe(0);
    expect([...differing(short, table(bitsOf(FAST), 0))]).toEqual([0, 6]);
    expect(differing(short, table(bitsOf(PLAIN, PLAIN), 1)).size).toBe(12);
  });
});

describe("a custom driver", () => {
  const driver = { driver: CUSTOM, fastDecay: false, signals: ["Zero", "PH_A", "PH_B"], names: ["x", "y", "z"] };

  it("takes bits in, out and elsewhere, with their names", () => {
    expect(moveBit(driver, 0, 2)).toMatchObject({ signals: ["PH_A", "PH_B", "Zero"], names: ["y", "z", "x"] });
    expect(moveBit(driver, 2, 0)).toMatchObject({ signals: ["PH_B", "Zero", "PH_A"] });
    expect(moveBit(driver, 0, -1)).toBe(driver);
    expect(removeBit(driver, 1)).toMatchObject({ signals: ["Zero", "PH_B"], names: ["x", "z"] });
    expect(insertBit(driver, 1, "One")).toMatchObject({
      signals: ["Zero", "One", "PH_A", "PH_B"],
      names: ["x", "", "y", "z"],
    });
    expect(setSignal(driver, 2, "Step").signals[2]).toBe("Step");
  });

  it("shows the names of its bits, which the RAM does not hold", () => {
    const bits = named(bitsOf([0x10, 6, 0x0e], [5]), [driver, known("tmc236")]);
    expect(bits.map((bit) => bit.bit_name)).toEqual(["x", "y", "z", ""]);
  });

  it("goes to the API with its signals, a known one with its name alone", () => {
    expect(request([driver, known("tmc249", true)])).toEqual([
      { driver: CUSTOM, fast_decay: false, signals: driver.signals, bit_names: driver.names },
      { driver: "tmc249", fast_decay: true },
    ]);
  });
});

describe("the step pulse of a TMC4210", () => {
  it("is 16 * (1 + STPDIV) clocks; at STPDIV 0 the chip's 500 kHz at 16 MHz fit", () => {
    expect(pulseLength(0, 16e6)).toBe(1e-6);
    expect(pulseLength(15, 16e6)).toBe(16e-6);
    expect(stepRateMax(0, 16e6)).toBe(500_000);
  });
});
