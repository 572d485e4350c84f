import { useQuery } from "@tanstack/react-query";
import { api } from "../../api/client";

/** An axis as it is read once a second, while `enabled`. */
export function useAxisReading(device: string, axis: number, enabled: boolean) {
  return useQuery({
    queryKey: ["axis", device, axis],
    queryFn: () => api.GET("/api/v1/devices/{device}/axes/{axis}", { path: { device, axis } }),
    enabled,
    refetchInterval: 1000,
  });
}
