import { useQuery } from "@tanstack/react-query";
import { api } from "../../api/client";

/** Ports come and go with cables: looked at every few seconds while the page is open. */
export function usePorts() {
  return useQuery({
    queryKey: ["ports"],
    queryFn: () => api.GET("/api/v1/ports"),
    refetchInterval: 4000,
  });
}
