import { useQuery } from "@tanstack/react-query";
import { api } from "../../api/client";
import type { StraightLine, TogetherMove } from "./starts";

/** The nets of the emulated devices, looked at while the page is open. */
export function useWiring() {
  return useQuery({
    queryKey: ["wiring"],
    queryFn: () => api.GET("/api/v1/wiring"),
    refetchInterval: 2000,
  });
}

/** Start all of them; throws ApiError. */
export function startTogether(moves: TogetherMove[], useWires: boolean) {
  return api.POST("/api/v1/start-together", { body: { moves, use_wires: useWires, start_wires: [] } });
}

/** How the present straight line goes, or the latest one went. */
export function useLine() {
  return useQuery({
    queryKey: ["straight-line"],
    queryFn: () => api.GET("/api/v1/straight-line"),
    refetchInterval: 500,
  });
}

/** What the planners expect of a line; throws ApiError. */
export function planLine(body: StraightLine) {
  return api.POST("/api/v1/straight-line/plan", { body });
}

/** Go there; throws ApiError. */
export function startLine(body: StraightLine) {
  return api.POST("/api/v1/straight-line", { body });
}

/** End it and stop its motors. */
export function stopLine() {
  return api.DELETE("/api/v1/straight-line", {});
}
