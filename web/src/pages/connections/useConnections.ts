import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";
import type { Device } from "../../api/queries";
import { removing } from "../../lib/wire/useLinkInfo";
import { changeBody, createBody, type Draft, linkOf } from "./draft";

export { useCatalog } from "../../api/queries";
export { usePorts } from "./queries";

/** The search for modules on a port: followed closely while it runs. */
export function useProbe() {
  const queries = useQueryClient();
  const state = useQuery({
    queryKey: ["probe"],
    queryFn: () => api.GET("/api/v1/ports/probe"),
    refetchInterval: (query) => (query.state.data?.running ? 250 : false),
  });
  const keep = (found: Schemas["ProbeState"]) => queries.setQueryData(["probe"], found);
  const start = useMutation({
    mutationFn: (body: Schemas["ProbeStart"]) => api.POST("/api/v1/ports/probe", { body }),
    onSuccess: keep,
  });
  const abort = useMutation({
    mutationFn: () => api.DELETE("/api/v1/ports/probe"),
    onSuccess: keep,
  });
  return { state, start, abort };
}

function useRefresh() {
  const queries = useQueryClient();
  return () => queries.invalidateQueries({ queryKey: ["devices"] });
}

export function useLinkSwitch(device: string) {
  const refresh = useRefresh();
  return useMutation({
    mutationFn: async (to: "connect" | "disconnect") => {
      const params = { path: { device } };
      return to === "connect"
        ? await api.POST("/api/v1/devices/{device}/connect", params)
        : await api.POST("/api/v1/devices/{device}/disconnect", params);
    },
    onSettled: refresh,
  });
}

export function useRemoveDevice(device: string) {
  const refresh = useRefresh();
  const queries = useQueryClient();
  return useMutation({
    mutationKey: removing(device),
    // what still asks for its wire would ask for a device that is gone
    onMutate: () => queries.cancelQueries({ queryKey: ["link", device] }),
    mutationFn: () => api.DELETE("/api/v1/devices/{device}", { path: { device } }),
    onSettled: refresh,
  });
}

/** Adds a device, or (with `edited`) changes one. */
export function useSaveDevice(edited: { device: Device; before: Draft } | null) {
  const refresh = useRefresh();
  return useMutation({
    mutationFn: async (draft: Draft): Promise<Pick<Device, "id">> => {
      if (edited === null)
        return await api.POST("/api/v1/devices", { body: createBody(draft) as Schemas["DeviceCreate"] });
      const body = changeBody(edited.before, draft);
      if (Object.keys(body).length === 0) return edited.device;
      return await api.PATCH("/api/v1/devices/{device}", {
        path: { device: edited.device.id },
        body: body as Schemas["DeviceChange"],
      });
    },
    onSettled: refresh,
  });
}

export function useLinkTest() {
  return useMutation({
    mutationFn: (draft: Draft) =>
      api.POST("/api/v1/devices/test", {
        body: { model: draft.model.name, link: linkOf(draft) } as Schemas["DeviceTrial"],
      }),
  });
}
