import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api } from "../../api/client";
import type { Device } from "../../api/queries";
import type { paths } from "../../api/schema";
import { forgetWritten } from "../../lib/rows/written";

type Calls = paths["/api/v1/devices/{device}/emulator"];
/** The plant of an emulated device, and what is at its pins, whatever its family. */
export type EmulatorState = Calls["get"]["responses"][200]["content"]["application/json"];
export type EmulatorPatch = NonNullable<Calls["patch"]["requestBody"]>["content"]["application/json"];

const key = (device: string) => ["emulator", device];

/**
 * Plant and pins of an emulated device; undefined for real ones. What moves comes by telemetry: this is asked
 * for now and then, and closely only while its controls are open.
 */
export function useEmulator(device: Device | undefined, closely = false) {
  return useQuery({
    queryKey: key(device?.id ?? ""),
    queryFn: (): Promise<EmulatorState> =>
      api.GET("/api/v1/devices/{device}/emulator", { path: { device: device?.id ?? "" } }),
    enabled: device?.emulated === true,
    refetchInterval: closely ? 500 : 3000,
  });
}

export function useChangeEmulator(device: string) {
  const queries = useQueryClient();
  return useMutation({
    mutationFn: (body: EmulatorPatch) => api.PATCH("/api/v1/devices/{device}/emulator", { path: { device }, body }),
    onSuccess: (state, body) => {
      if (body.power_cycle) forgetWritten(device);
      queries.setQueryData(key(device), state);
    },
  });
}
