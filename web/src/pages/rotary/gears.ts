import { coordinate } from "../../lib/format";

/** More teeth than this are drawn as a rim. */
const MOST_TEETH = 64;
/** Fewer than this look like no gear: then both get a multiple, the ratio stays. */
const LEAST_TEETH = 9;

export interface DrawnGear {
  x: number;
  radius: number;
  teeth: number;
  path: string;
}

/** The outline of a gear around (0, 0): trapezoids on a root circle. */
export function outline(teeth: number, pitch: number, depth: number): string {
  if (teeth > MOST_TEETH) return `M${-pitch} 0A${pitch} ${pitch} 0 1 1 ${pitch} 0A${pitch} ${pitch} 0 1 1 ${-pitch} 0Z`;
  const step = (2 * Math.PI) / teeth;
  const corner = (angle: number, radius: number) =>
    `${coordinate(radius * Math.sin(angle))} ${coordinate(-radius * Math.cos(angle))}`;
  const parts: string[] = [];
  for (let tooth = 0; tooth < teeth; tooth++) {
    const middle = tooth * step;
    for (const [share, radius] of [
      [-0.3, pitch - depth],
      [-0.14, pitch + depth],
      [0.14, pitch + depth],
      [0.3, pitch - depth],
    ] as const)
      parts.push(corner(middle + share * step, radius));
  }
  return `M${parts.join("L")}Z`;
}

/** Motor's and shaft's gear side by side in a box of `width`, their pitch circles touching. */
export function pair(motorTeeth: number, drivenTeeth: number, width: number): { motor: DrawnGear; driven: DrawnGear } {
  const sum = motorTeeth + drivenTeeth;
  // a gear with a thousandth of the other's teeth would not be seen
  const share = Math.min(0.84, Math.max(0.16, motorTeeth / sum));
  const outer = width / 2 - 6;
  const [motor, driven] = [outer * share, outer * (1 - share)];
  const by = Math.ceil(LEAST_TEETH / Math.min(motorTeeth, drivenTeeth));
  const teeth: readonly [number, number] = [motorTeeth * by, drivenTeeth * by];
  const depth = Math.min(3.4, Math.max(0.8, (1.7 * outer) / (teeth[0] + teeth[1])));
  const left = -width / 2 + 5 + motor;
  return {
    motor: { x: left, radius: motor, teeth: teeth[0], path: outline(teeth[0], motor, depth) },
    driven: { x: left + motor + driven, radius: driven, teeth: teeth[1], path: outline(teeth[1], driven, depth) },
  };
}
