import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api } from "../../api/client";
import type { LineState, StraightLine, TogetherMove } from "./starts";
import type { Pin } from "./wires";

const WIRING_KEY = ["wiring"];
/** Of all that is known of the latest straight line. */
export const LINE_KEY = ["straight-line"];

/** The nets of the emulated devices, looked at while the page is open. */
export function useWiring() {
  return useQuery({
    queryKey: WIRING_KEY,
    queryFn: () => api.GET("/api/v1/wiring"),
    refetchInterval: 2000,
  });
}

/** Have exactly these pins on a net; none removes it. */
export function useWirePins() {
  const queries = useQueryClient();
  return useMutation({
    mutationFn: ({ net, pins }: { net: string; pins: Pin[] }) => {
      const path = { net };
      return pins.length === 0
        ? api.DELETE("/api/v1/wiring/{net}", { path })
        : api.PUT("/api/v1/wiring/{net}", { path, body: { pins } });
    },
    onSuccess: (wiring) => queries.setQueryData(WIRING_KEY, wiring),
  });
}

/** Start all of them; throws ApiError. */
export function startTogether(moves: TogetherMove[], useWires: boolean) {
  return api.POST("/api/v1/start-together", { body: { moves, use_wires: useWires, start_wires: [] } });
}

/** How the present straight line goes, or the latest one went. */
export function useLine() {
  return useQuery({
    queryKey: LINE_KEY,
    queryFn: () => api.GET("/api/v1/straight-line"),
    refetchInterval: 500,
  });
}

/** Where the axes of a line were seen; looked at again while it goes, and once after its end. */
export function useLinePath(state: LineState | undefined) {
  return useQuery({
    queryKey: [...LINE_KEY, "path", state?.state, state?.leg],
    queryFn: () => api.GET("/api/v1/straight-line/path"),
    enabled: state !== undefined && state.state !== "idle",
    refetchInterval: state?.state === "running" ? 1000 : false,
    placeholderData: (before) => before,
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
