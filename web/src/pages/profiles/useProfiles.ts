import { keepPreviousData, useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";

/** A kept profile without its document. */
export type Saved = Schemas["ProfileInfo"];
export type Profile = Schemas["ProfileDocument"];
export type Diff = Schemas["Diff"];
export type Applied = Schemas["ProfileApplied"];

/** All kept profiles; with words those that have them in name, note, model or device. */
export function useProfiles(search: string) {
  return useQuery({
    queryKey: ["profiles", "list", search],
    queryFn: async () => (await api.GET("/api/v1/profiles", { query: { search } })).profiles,
    placeholderData: keepPreviousData,
  });
}

export function useProfile(id: number) {
  return useQuery({
    queryKey: ["profiles", id],
    queryFn: async () => {
      const answer = await api.GET("/api/v1/profiles/{profile}", { path: { profile: id } });
      return answer as Schemas["ProfileDetail"]; // no file was asked for
    },
  });
}

function useRefresh() {
  const queries = useQueryClient();
  return () => queries.invalidateQueries({ queryKey: ["profiles"] });
}

/** Keeps a document, or what a device holds now. */
export function useSave() {
  const refresh = useRefresh();
  return useMutation({
    mutationFn: (body: Schemas["ProfileSave"]) => api.POST("/api/v1/profiles", { body }),
    onSettled: refresh,
  });
}

/** Finds out what of a device can be set, where its list of parameters does not tell. */
export function useTry() {
  return useMutation({
    mutationFn: (device: string) => api.POST("/api/v1/devices/{device}/profile/try", { path: { device } }),
  });
}

export function useRename(id: number) {
  const refresh = useRefresh();
  return useMutation({
    mutationFn: (body: Schemas["ProfileLabel"]) =>
      api.PATCH("/api/v1/profiles/{profile}", { path: { profile: id }, body }),
    onSettled: refresh,
  });
}

export function useRemove(id: number) {
  const queries = useQueryClient();
  return useMutation({
    mutationFn: () => api.DELETE("/api/v1/profiles/{profile}", { path: { profile: id } }),
    // the list alone: who still shows the profile need not be told that it is gone
    onSettled: () => queries.invalidateQueries({ queryKey: ["profiles", "list"] }),
  });
}

/** The document as a file: one register a line. */
export async function fileOf(id: number): Promise<string> {
  const answer = await api.GET("/api/v1/profiles/{profile}/file", { path: { profile: id }, parseAs: "text" });
  return answer as unknown as string;
}

/** What applying would change in the device now: nothing is written. Asked when the profile is looked at, and again. */
export function useDryRun(device: string | undefined, profile: Profile | undefined, enabled: boolean) {
  return useQuery({
    queryKey: ["profiles", "dry run", device, profile],
    queryFn: () =>
      api.PUT("/api/v1/devices/{device}/profile", {
        path: { device: device ?? "" },
        query: { dry_run: true },
        body: profile as Schemas["ProfileIn"],
      }),
    enabled: enabled && device !== undefined && profile !== undefined,
    staleTime: 0,
    retry: false,
  });
}

/** Another kept profile on the left, this one on the right. */
export function useComparison(left: number | null, right: number) {
  return useQuery({
    queryKey: ["profiles", right, "against", left],
    queryFn: () => api.POST("/api/v1/profiles/compare", { body: { left: left ?? 0, right } }),
    enabled: left !== null,
    retry: false,
  });
}

export function useApply(device: string | undefined) {
  const queries = useQueryClient();
  return useMutation({
    mutationFn: ({ profile, limits }: { profile: Profile; limits: boolean }) =>
      api.PUT("/api/v1/devices/{device}/profile", {
        path: { device: device ?? "" },
        query: { limits },
        body: profile as Schemas["ProfileIn"],
      }),
    onSettled: () => {
      // registers, mechanics and the difference are others now
      void queries.invalidateQueries({ queryKey: ["profiles", "dry run"] });
      void queries.invalidateQueries({ queryKey: ["profiles", "apply", device] });
      void queries.invalidateQueries({ queryKey: ["registers", device] });
      void queries.invalidateQueries({ queryKey: ["devices"] });
    },
  });
}

/** How far the transaction under way is, whoever began it, and what an earlier one has left. */
export function useApplyState(device: string | undefined, running: boolean) {
  return useQuery({
    queryKey: ["profiles", "apply", device],
    queryFn: () => api.GET("/api/v1/devices/{device}/profile/apply", { path: { device: device ?? "" } }),
    enabled: device !== undefined,
    refetchInterval: (query) => (running || query.state.data?.state === "running" ? 150 : 5000),
  });
}

export function useUnfinished(device: string | undefined) {
  const queries = useQueryClient();
  const params = { path: { device: device ?? "" } };
  const onSettled = () => queries.invalidateQueries({ queryKey: ["profiles"] });
  const takeBack = useMutation({
    mutationFn: () => api.POST("/api/v1/devices/{device}/profile/apply/way-back", params),
    onSettled,
  });
  const forget = useMutation({
    mutationFn: () => api.DELETE("/api/v1/devices/{device}/profile/apply", params),
    onSettled,
  });
  return { takeBack, forget };
}
