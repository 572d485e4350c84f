import { coordinate } from "../../../lib/format";
/** Microsteps of the sine table: a turn of the field. */
export const ELECTRICAL_TURN = 1024;

/** An angle of the table as electrical degrees: CL_BETA 255 is 89.6. */
export function degrees(units: number): number {
  return (units * 360) / ELECTRICAL_TURN;
}

/** A place on a circle around (0, 0): 0 degrees is up, positive ones go clockwise. */
export function onCircle(angleDeg: number, radius: number): { x: number; y: number } {
  const angle = (angleDeg * Math.PI) / 180;
  return { x: radius * Math.sin(angle), y: -radius * Math.cos(angle) };
}

/** A ring's sector from one angle to a greater one, as an SVG path around (0, 0). */
export function sector(fromDeg: number, toDeg: number, inner: number, outer: number): string {
  const span = Math.min(359.99, toDeg - fromDeg);
  const large = span > 180 ? 1 : 0;
  const at = (angle: number, radius: number) => {
    const { x, y } = onCircle(angle, radius);
    return `${coordinate(x)} ${coordinate(y)}`;
  };
  const end = fromDeg + span;
  return (
    `M${at(fromDeg, outer)}A${outer} ${outer} 0 ${large} 1 ${at(end, outer)}` +
    `L${at(end, inner)}A${inner} ${inner} 0 ${large} 0 ${at(fromDeg, inner)}Z`
  );
}

/** Where the rotor is said to be in its field. */
export function zoneOf(loadDeg: number, betaDeg: number): "unknown" | "holding" | "limit" | "beyond" {
  if (Number.isNaN(loadDeg)) return "unknown";
  const size = Math.abs(loadDeg);
  // A quarter turn is where a field pulls hardest: what lies beyond is on its way to the next pole.
  if (size > Math.max(90, betaDeg) + 1) return "beyond";
  return size >= betaDeg - 2 ? "limit" : "holding";
}
