import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas, unwrap } from "../../api/client";
import type { Device } from "../../api/queries";
import { changeBody, createBody, type Draft, linkOf } from "./draft";

export { useCatalog } from "../../api/queries";
export { usePorts } from "./queries";

/** The search for modules on a port: followed closely while it runs. */
export function useProbe() {
  const queries = useQueryClient();
  const state = useQuery({
    queryKey: ["probe"],
    queryFn: async () => unwrap(await api.GET("/api/v1/ports/probe")),
    refetchInterval: (query) => (query.state.data?.running ? 250 : false),
  });
  const keep = (found: Schemas["ProbeState"]) => queries.setQueryData(["probe"], found);
  const start = useMutation({
    mutationFn: async (body: Schemas["ProbeStart"]) => unwrap(await api.POST("/api/v1/ports/probe", { body })),
    onSuccess: keep,
  });
  const abort = useMutation({
    mutationFn: async () => unwrap(await api.DELETE("/api/v1/ports/probe")),
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
      const params = { params: { path: { device } } };
      return to === "connect"
        ? unwrap(await api.POST("/api/v1/devices/{device}/connect", params))
        : unwrap(await api.POST("/api/v1/devices/{device}/disconnect", params));
    },
    onSettled: refresh,
  });
}

export function useRemoveDevice(device: string) {
  const refresh = useRefresh();
  return useMutation({
    mutationFn: async () => {
      const answer = await api.DELETE("/api/v1/devices/{device}", { params: { path: { device } } });
      // 204 has no body, which `unwrap` would take for a failure.
      if (!answer.response.ok) unwrap(answer);
    },
    onSettled: refresh,
  });
}

/** Adds a device, or (with `edited`) changes one. */
export function useSaveDevice(edited: { device: Device; before: Draft } | null) {
  const refresh = useRefresh();
  return useMutation({
    mutationFn: async (draft: Draft) => {
      if (edited === null)
        return unwrap(await api.POST("/api/v1/devices", { body: createBody(draft) as Schemas["DeviceCreate"] }));
      const body = changeBody(edited.before, draft);
      if (Object.keys(body).length === 0) return edited.device as Schemas["DeviceInfo"];
      return unwrap(
        await api.PATCH("/api/v1/devices/{device}", { params: { path: { device: edited.device.id } }, body }),
      );
    },
    onSettled: refresh,
  });
}

export function useLinkTest() {
  return useMutation({
    mutationFn: async (draft: Draft) =>
      unwrap(
        await api.POST("/api/v1/devices/test", {
          body: { model: draft.model.name, link: linkOf(draft) } as Schemas["DeviceTrial"],
        }),
      ),
  });
}
