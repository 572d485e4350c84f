import { useQuery } from "@tanstack/react-query";
import { api } from "../../api/client";
import type { TogetherMove } from "./starts";

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
