import { api, type Schemas, unwrap } from "./client";
import { gate } from "./lease/bench";

export interface AxisAddress {
  device: string;
  axis: number;
}

const path = ({ device, axis }: AxisAddress) => ({ params: { path: { device, axis } } });

/** What moves motors, each call one request. All of them throw ApiError. */
export const motion = {
  move: async (at: AxisAddress, body: Schemas["Move"]) =>
    unwrap(await api.POST("/api/v1/devices/{device}/axes/{axis}/move", { ...path(at), body })),
  moveTogether: async (device: string, moves: Schemas["AxisMove"][]) =>
    unwrap(await api.POST("/api/v1/devices/{device}/move", { params: { path: { device } }, body: { moves } })),
  rotate: async (at: AxisAddress, body: Schemas["Rotate"]) =>
    unwrap(await api.POST("/api/v1/devices/{device}/axes/{axis}/rotate", { ...path(at), body })),
  /** For as long as something is held down: without the bench it asks for it, and does not begin later. */
  jog: async (at: AxisAddress, body: Schemas["Rotate"]) =>
    unwrap(await api.POST("/api/v1/devices/{device}/axes/{axis}/rotate", { ...path(at), body, fetch: gate.held })),
  keepRotating: async (at: AxisAddress, body: Schemas["KeepRotating"]) =>
    unwrap(await api.PATCH("/api/v1/devices/{device}/axes/{axis}/rotate", { ...path(at), body, fetch: gate.quiet })),
  stop: async (at: AxisAddress, mode: "ramp" | "immediate") =>
    unwrap(await api.POST("/api/v1/devices/{device}/axes/{axis}/stop", { ...path(at), body: { mode } })),
  shuttle: async (at: AxisAddress, body: Schemas["ShuttleStart"]) =>
    unwrap(await api.POST("/api/v1/devices/{device}/axes/{axis}/shuttle", { ...path(at), body })),
  endShuttle: async (at: AxisAddress) =>
    unwrap(await api.DELETE("/api/v1/devices/{device}/axes/{axis}/shuttle", path(at))),
  search: async (at: AxisAddress, body: Schemas["ReferenceSearchStart"]) =>
    unwrap(await api.POST("/api/v1/devices/{device}/axes/{axis}/reference-search", { ...path(at), body })),
  endSearch: async (at: AxisAddress) =>
    unwrap(await api.DELETE("/api/v1/devices/{device}/axes/{axis}/reference-search", path(at))),
};
