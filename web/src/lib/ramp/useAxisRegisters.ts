import { useQuery } from "@tanstack/react-query";
import { api } from "../../api/client";
import type { Device } from "../../api/queries";

/**
 * An axis' registers, looked at once a second: a design is always compared with what the chip holds now. Those that
 * cannot be read are among them as far as the server knows them.
 */
export function useAxisRegisters(device: Device | undefined, axis: number, group?: readonly string[]) {
  const connected = device?.state === "connected";
  const id = device?.id ?? "";
  const readings = useQuery({
    queryKey: ["registers", id, axis, ...(group ?? [])],
    queryFn: ({ signal }) =>
      api.GET("/api/v1/devices/{device}/registers", {
        path: { device: id },
        query: { axis, kept: true, ...(group ? { group: [...group] } : {}) },
        signal,
      }),
    enabled: connected,
    refetchInterval: 1000,
  });
  return { connected, readings };
}
