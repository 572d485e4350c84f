import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas, unwrap } from "../../api/client";
import type { Device } from "../../api/queries";

export type EmulatorState = Schemas["EmulatorState"];
export type EmulatorAxis = EmulatorState["axes"][number];
export type EmulatorPatch = Schemas["EmulatorPatch"];

const key = (device: string) => ["emulator", device];

/**
 * The world behind an emulated device's pins; undefined for real devices. What moves comes by telemetry: this is asked
 * for now and then, and closely only while its controls are open.
 */
export function useEmulator(device: Device | undefined, closely = false) {
  return useQuery({
    queryKey: key(device?.id ?? ""),
    queryFn: async () =>
      unwrap(await api.GET("/api/v1/devices/{device}/emulator", { params: { path: { device: device?.id ?? "" } } })),
    enabled: device?.emulated === true,
    refetchInterval: closely ? 500 : 3000,
  });
}

export function useChangeEmulator(device: string) {
  const queries = useQueryClient();
  return useMutation({
    mutationFn: async (body: EmulatorPatch) =>
      unwrap(await api.PATCH("/api/v1/devices/{device}/emulator", { params: { path: { device } }, body })),
    onSuccess: (state) => queries.setQueryData(key(device), state),
  });
}
