import { useQuery } from "@tanstack/react-query";
import { api } from "../../../api/client";
import type { AxisAddress } from "../../../api/motion";

export const searchKey = (at: AxisAddress) => ["reference-search", at.device, at.axis];

/** The reference search of an axis: closely while one runs, else now and then. One question for all who ask. */
export function useSearch(at: AxisAddress, enabled: boolean) {
  return useQuery({
    queryKey: searchKey(at),
    queryFn: () => api.GET("/api/v1/devices/{device}/axes/{axis}/reference-search", { path: at }),
    enabled,
    refetchInterval: (query) => (query.state.data?.state === "running" ? 200 : 2000),
  });
}
