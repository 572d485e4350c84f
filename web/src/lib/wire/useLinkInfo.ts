import { useIsMutating, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";
import type { Device } from "../../api/queries";

export type LinkInfo = Schemas["LinkInfo"];

/** Key of the mutation that removes a device. */
export const removing = (id: string) => ["remove device", id];

/** What a device's wire can carry and carries, looked at once a second while it is connected and not being removed. */
export function useLinkInfo(device: Device | undefined) {
  const id = device?.id ?? "";
  const queries = useQueryClient();
  const goes = useIsMutating({ mutationKey: removing(id) }) > 0;
  return useQuery({
    queryKey: ["link", id],
    queryFn: async ({ signal }) => {
      const known = queries.getQueryData<LinkInfo>(["link", id]);
      // its turn may come before the page has been drawn without it
      if (known && queries.isMutating({ mutationKey: removing(id) }) > 0) return known;
      return await api.GET("/api/v1/devices/{device}/link", { path: { device: id }, signal });
    },
    enabled: !goes && device !== undefined && device.state !== "disconnected",
    refetchInterval: 1000,
    staleTime: 0,
  });
}
