import { coordinate } from "../../lib/format";

type Vector = readonly [number, number, number];

/** Where the server's own camera is, which suits pictures half as wide again as high (app/twin/child.py). */
const LOOK_AT: Vector = [2.55, 0, -1.2];
const CAMERA: Vector = [5.55, -16.4, 4.4];
const SUITS = 1.2;

/** Address of the picture: dark or light, and in a narrow frame from further away, so that all of it is in. */
export function viewOf(path: string, scheme: "light" | "dark", aspect: number): string {
  const query: string[] = [];
  if (scheme === "dark") query.push("darkMode");
  if (aspect > 0 && aspect < SUITS) {
    const away = SUITS / aspect;
    const camera = CAMERA.map((at, axis) => (LOOK_AT[axis] ?? 0) + (at - (LOOK_AT[axis] ?? 0)) * away);
    query.push(`initialCameraPosition=${camera.map((at) => coordinate(at)).join(",")}`);
    query.push(`initialCameraLookAt=${LOOK_AT.join(",")}`);
  }
  return query.length === 0 ? path : `${path}?${query.join("&")}`;
}
