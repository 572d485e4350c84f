import { useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";
import type { Device } from "../../api/queries";

export type LinkInfo = Schemas["LinkInfo"];

/** Key of the mutation that removes a device. */
export const removing = (id: string) => ["remove device", id];

/** What a device's wire can carry and carries, looked at once a second while it is connected; null: it is going. */
export function useLinkInfo(device: Device | undefined) {
  const id = device?.id ?? "";
  const queries = useQueryClient();
  return useQuery({
    queryKey: ["link", id],
    queryFn: async ({ signal }) => {
      // a turn may come while it is being removed, and before the page has been drawn without it
      const listed = queries.getQueryData<Device[]>(["devices"])?.some((each) => each.id === id) ?? true;
      if (!listed || queries.isMutating({ mutationKey: removing(id) }) > 0)
        return queries.getQueryData<LinkInfo>(["link", id]) ?? null;
      return await api.GET("/api/v1/devices/{device}/link", { path: { device: id }, signal });
    },
    enabled: device !== undefined && device.state !== "disconnected",
    refetchInterval: 1000,
    staleTime: 0,
  });
}
