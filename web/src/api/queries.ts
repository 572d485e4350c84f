import { useQuery } from "@tanstack/react-query";
import { api, type Schemas, unwrap } from "./client";

export type Device = Schemas["DeviceInfo"];

/** All devices, looked at once a second: connection states change by themselves. */
export function useDevices() {
  return useQuery({
    queryKey: ["devices"],
    queryFn: async () => unwrap(await api.GET("/api/v1/devices")),
    refetchInterval: 1000,
  });
}

export function useCatalogModel(model: string | undefined) {
  return useQuery({
    queryKey: ["catalog", model],
    queryFn: async () => unwrap(await api.GET("/api/v1/catalog/{model}", { params: { path: { model: model ?? "" } } })),
    enabled: model !== undefined,
    staleTime: Number.POSITIVE_INFINITY,
  });
}
