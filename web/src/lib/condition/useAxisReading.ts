import { useQuery } from "@tanstack/react-query";
import { api, unwrap } from "../../api/client";

/** An axis as it is read once a second, while `enabled`. */
export function useAxisReading(device: string, axis: number, enabled: boolean) {
  return useQuery({
    queryKey: ["axis", device, axis],
    queryFn: async () =>
      unwrap(await api.GET("/api/v1/devices/{device}/axes/{axis}", { params: { path: { device, axis } } })),
    enabled,
    refetchInterval: 1000,
  });
}
