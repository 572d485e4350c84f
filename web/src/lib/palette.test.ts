import { describe, expect, it } from "vitest";
import tokens from "../tokens.css?raw";
import { colorOf, KINDS, type Kind, lineOf } from "./palette";

type Triple = readonly [number, number, number];
type Matrix = readonly [Triple, Triple, Triple];

/** Machado, Oliveira, Fernandes 2009, severity 1.0, on linear RGB. */
const SIGHTS: Record<string, Matrix> = {
  normal: [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
  ],
  protan: [
    [0.152286, 1.052583, -0.204868],
    [0.114503, 0.786281, 0.099216],
    [-0.003882, -0.048116, 1.051998],
  ],
  deutan: [
    [0.367322, 0.860646, -0.227968],
    [0.280085, 0.672501, 0.047413],
    [-0.01182, 0.04294, 0.968881],
  ],
  tritan: [
    [1.255528, -0.076749, -0.178779],
    [-0.078411, 0.930809, 0.147602],
    [0.004733, 0.691367, 0.3039],
  ],
};
const XYZ: Matrix = [
  [0.4124564, 0.3575761, 0.1804375],
  [0.2126729, 0.7151522, 0.072175],
  [0.0193339, 0.119192, 0.9503041],
];
const WHITE: Triple = [0.95047, 1, 1.08883];

function times(matrix: Matrix, [a, b, c]: Triple): Triple {
  const [x, y, z] = matrix.map((row) => row[0] * a + row[1] * b + row[2] * c);
  return [x ?? 0, y ?? 0, z ?? 0];
}

function linear(hex: string): Triple {
  const [r, g, b] = [1, 3, 5].map((at) => {
    const share = Number.parseInt(hex.slice(at, at + 2), 16) / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  return [r ?? 0, g ?? 0, b ?? 0];
}

/** CIELAB as somebody of this sight sees it. */
function seen(hex: string, sight: Matrix): Triple {
  const [r, g, b] = times(sight, linear(hex));
  const within = (value: number) => Math.min(1, Math.max(0, value));
  const [x, y, z] = times(XYZ, [within(r), within(g), within(b)]);
  const f = (share: number) => (share > 0.008856 ? Math.cbrt(share) : 7.787 * share + 16 / 116);
  const [fx, fy, fz] = [f(x / WHITE[0]), f(y / WHITE[1]), f(z / WHITE[2])];
  return [116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)];
}

function distance(one: string, other: string): number {
  return Math.min(
    ...Object.values(SIGHTS).map((sight) => {
      const [a, b] = [seen(one, sight), seen(other, sight)];
      return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    }),
  );
}

function contrast(one: string, other: string): number {
  const [dark = 0, light = 0] = [one, other].map((hex) => times(XYZ, linear(hex))[1]).sort((a, b) => a - b);
  return (light + 0.05) / (dark + 0.05);
}

function pairs(scheme: "light" | "dark"): [pair: string, distance: number][] {
  const kinds = Object.keys(KINDS) as Kind[];
  return kinds.flatMap((one, at) =>
    kinds
      .slice(at + 1)
      .map((other): [string, number] => [`${one}, ${other}`, distance(KINDS[one][scheme], KINDS[other][scheme])]),
  );
}

describe("the colours of traces", () => {
  it("are measured as published: black and white are 100 apart to everybody", () => {
    expect(distance("#000000", "#ffffff")).toBeCloseTo(100, 1);
    expect(contrast("#000000", "#ffffff")).toBeCloseTo(21, 5);
    // red and green of one lightness are one colour to a deutan
    expect(distance("#a86400", "#008060")).toBeGreaterThan(distance("#a86400", "#6f7f00"));
  });

  it("are told apart by every sight, on light and on dark ground", () => {
    const light = new Map(pairs("light"));
    // seldom in one plot, and then of different scales
    expect(light.get("measured, velocity")).toBeGreaterThan(11.8);
    light.delete("measured, velocity");
    expect([...light].filter(([, apart]) => apart < 14.5)).toEqual([]);
    expect(pairs("dark").filter(([, apart]) => apart < 16.9)).toEqual([]);
  });

  it("are legible as text", () => {
    for (const { light, dark } of Object.values(KINDS)) {
      expect(contrast(light, "#ffffff")).toBeGreaterThan(4.6);
      expect(contrast(dark, "#1a1b1e")).toBeGreaterThan(5.2);
      expect(contrast(dark, "#242424")).toBeGreaterThan(4.5);
    }
  });

  it("are those of the sheets", () => {
    const named: Record<string, Kind> = {
      blue: "measured",
      green: "velocity",
      orange: "predicted",
      violet: "load",
      magenta: "encoder",
      olive: "current",
      slate: "target",
    };
    for (const [name, kind] of Object.entries(named))
      expect(tokens).toContain(`--${name}: light-dark(${KINDS[kind].light}, ${KINDS[kind].dark});`);
  });

  it("stay with a quantity, and with the name of any register", () => {
    expect(colorOf("position", "dark")).toBe(KINDS.measured.dark);
    expect(colorOf("DRV_STATUS", "light")).toBe(colorOf("DRV_STATUS", "light"));
    expect(lineOf("external_deviation", "light")).toEqual({ color: KINDS.encoder.light, dash: [5, 3] });
    expect(lineOf("position", "light")).toEqual({ color: KINDS.measured.light });
  });
});
