import { useQuery } from "@tanstack/react-query";
import { api, unwrap } from "../../api/client";

export function useCatalog() {
  return useQuery({
    queryKey: ["catalog"],
    queryFn: async () => unwrap(await api.GET("/api/v1/catalog")),
    staleTime: Number.POSITIVE_INFINITY,
  });
}

/** Ports come and go with cables: looked at every few seconds while the page is open. */
export function usePorts() {
  return useQuery({
    queryKey: ["ports"],
    queryFn: async () => unwrap(await api.GET("/api/v1/ports")),
    refetchInterval: 4000,
  });
}
