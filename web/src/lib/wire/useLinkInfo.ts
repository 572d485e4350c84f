import { useQuery } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";
import type { Device } from "../../api/queries";

export type LinkInfo = Schemas["LinkInfo"];

/** What a device's wire can carry and carries, looked at once a second while it is connected. */
export function useLinkInfo(device: Device | undefined) {
  const id = device?.id ?? "";
  return useQuery({
    queryKey: ["link", id],
    queryFn: ({ signal }) => api.GET("/api/v1/devices/{device}/link", { path: { device: id }, signal }),
    enabled: device !== undefined && device.state !== "disconnected",
    refetchInterval: 1000,
    staleTime: 0,
  });
}
