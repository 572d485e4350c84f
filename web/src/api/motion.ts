import { api, type Schemas } from "./client";
import { gate } from "./lease/bench";

export interface AxisAddress {
  device: string;
  axis: number;
}

const path = ({ device, axis }: AxisAddress) => ({ path: { device, axis } });

/** What moves motors, each call one request. All of them throw ApiError. */
export const motion = {
  move: (at: AxisAddress, body: Schemas["Move"]) =>
    api.POST("/api/v1/devices/{device}/axes/{axis}/move", { ...path(at), body }),
  moveTogether: (device: string, moves: Schemas["AxisMove"][]) =>
    api.POST("/api/v1/devices/{device}/move", { path: { device }, body: { moves } }),
  rotate: (at: AxisAddress, body: Schemas["Rotate"]) =>
    api.POST("/api/v1/devices/{device}/axes/{axis}/rotate", { ...path(at), body }),
  /** For as long as something is held down: without the bench it asks for it, and does not begin later. */
  jog: (at: AxisAddress, body: Schemas["Rotate"]) =>
    api.POST("/api/v1/devices/{device}/axes/{axis}/rotate", { ...path(at), body, fetch: gate.held }),
  keepRotating: (at: AxisAddress, body: Schemas["KeepRotating"]) =>
    api.PATCH("/api/v1/devices/{device}/axes/{axis}/rotate", { ...path(at), body, fetch: gate.quiet }),
  stop: (at: AxisAddress, mode: "ramp" | "immediate") =>
    api.POST("/api/v1/devices/{device}/axes/{axis}/stop", { ...path(at), body: { mode } }),
  shuttle: (at: AxisAddress, body: Schemas["ShuttleStart"]) =>
    api.POST("/api/v1/devices/{device}/axes/{axis}/shuttle", { ...path(at), body }),
  endShuttle: (at: AxisAddress) => api.DELETE("/api/v1/devices/{device}/axes/{axis}/shuttle", path(at)),
  search: (at: AxisAddress, body: Schemas["ReferenceSearchStart"]) =>
    api.POST("/api/v1/devices/{device}/axes/{axis}/reference-search", { ...path(at), body }),
  endSearch: (at: AxisAddress) => api.DELETE("/api/v1/devices/{device}/axes/{axis}/reference-search", path(at)),
};
