import { coordinate, fixed } from "../../lib/format";
/** Geometry of the dial: 0 degrees is up, positive angles go clockwise, around (0, 0). */
export const FACE = 176;
export const RIM = 162;
export const HUB = 84;

/** Below this the hand moves less than a pixel; an arc of it would be a dot. */
const LEAST_DEG = 0.05;

export function at(angleDeg: number, radius: number): readonly [x: number, y: number] {
  const angle = (angleDeg * Math.PI) / 180;
  return [radius * Math.sin(angle), -radius * Math.cos(angle)];
}

const point = (angleDeg: number, radius: number) =>
  at(angleDeg, radius)
    .map((value) => coordinate(value))
    .join(" ");

/** An arc from one angle by `sweepDeg`, either way; beyond a turn it is the whole ring. Empty where there is no way. */
export function arc(fromDeg: number, sweepDeg: number, radius: number): string {
  if (Math.abs(sweepDeg) < LEAST_DEG) return "";
  const way = sweepDeg > 0 ? 1 : 0;
  if (Math.abs(sweepDeg) >= 359.9) {
    const half = fromDeg + 180;
    return (
      `M${point(fromDeg, radius)}A${radius} ${radius} 0 0 ${way} ${point(half, radius)}` +
      `A${radius} ${radius} 0 0 ${way} ${point(fromDeg, radius)}`
    );
  }
  const large = Math.abs(sweepDeg) > 180 ? 1 : 0;
  return `M${point(fromDeg, radius)}A${radius} ${radius} 0 ${large} ${way} ${point(fromDeg + sweepDeg, radius)}`;
}

/** An arrow's head at the end of such an arc, pointing the way it goes; smaller where the way is short. */
export function arrow(fromDeg: number, sweepDeg: number, radius: number, size = 9): string {
  if (Math.abs(sweepDeg) < 2) return "";
  const way = Math.sign(sweepDeg);
  const end = fromDeg + sweepDeg;
  const length = (Math.min(size, (Math.abs(sweepDeg) * Math.PI * radius) / 360) / radius) * (180 / Math.PI);
  const back = end - way * length * 1.6;
  return `M${point(end, radius)}L${point(back, radius + size * 0.7)}L${point(back, radius - size * 0.7)}Z`;
}

/** The nearest whole turn's part of a way: what an arc can show, and the turns that it cannot. */
export function wayParts(degrees: number): { turns: number; rest: number } {
  const turns = Math.trunc(degrees / 360);
  return { turns, rest: degrees - turns * 360 };
}

/** "+2 turns 90°", "−12.5°": a way in words. */
export function wayText(degrees: number): string {
  const { turns, rest } = wayParts(degrees);
  const sign = degrees < 0 ? "−" : "+";
  const size = Math.abs(rest);
  const part = fixed(size, size < 10 ? 2 : 1, "deg");
  if (turns === 0) return `${sign}${part}`;
  const whole = Math.abs(turns);
  return `${sign}${fixed(whole)} ${whole === 1 ? "turn" : "turns"} ${part}`;
}

/** The smaller way from one angle to another, -180..180 [deg]. */
export function between(fromDeg: number, toDeg: number): number {
  const way = (((toDeg - fromDeg) % 360) + 540) % 360;
  return way - 180;
}
