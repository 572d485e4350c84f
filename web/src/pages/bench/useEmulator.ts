import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas, unwrap } from "../../api/client";
import type { Device } from "../../api/queries";
import { familyOf } from "../../lib/family";
import { forgetWritten } from "../../lib/rows/written";

export type ChipState = Schemas["EmulatorState"];
export type Tmc4361State = Schemas["Tmc4361State"];
export type ChipAxis = ChipState["axes"][number];
export type Pd42State = Schemas["Pd42State"];
export type Tmc5xxxState = Schemas["Tmc5xxxState"];
export type EmulatorState = ChipState | Tmc4361State | Tmc5xxxState | Pd42State;
export type ChipPatch = Schemas["EmulatorPatch"];
export type Tmc4361Patch = Schemas["Tmc4361Patch"];
export type Pd42Patch = Schemas["Pd42Patch"];
export type Tmc5xxxPatch = Schemas["Tmc5xxxPatch"];
export type EmulatorPatch = ChipPatch | Tmc4361Patch | Tmc5xxxPatch | Pd42Patch;

export function isModuleState(state: EmulatorState): state is Pd42State {
  return state.model === "pd42-1241";
}

export function isTmc4361State(state: EmulatorState): state is Tmc4361State {
  return state.model === "tmc4361";
}

export function isTmc5xxxState(state: EmulatorState): state is Tmc5xxxState {
  return familyOf(state.model) === "sixpoint";
}

const key = (device: string) => ["emulator", device];

/**
 * The world behind an emulated device's pins; undefined for real devices. What moves comes by telemetry: this is asked
 * for now and then, and closely only while its controls are open.
 */
export function useEmulator(device: Device | undefined, closely = false) {
  return useQuery({
    queryKey: key(device?.id ?? ""),
    queryFn: async (): Promise<EmulatorState> =>
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
    onSuccess: (state, body) => {
      if (body.power_cycle) forgetWritten(device);
      queries.setQueryData(key(device), state);
    },
  });
}
