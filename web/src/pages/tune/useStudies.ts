import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api } from "../../api/client";
import type { Wish } from "./study";

/** All studies and which kinds there are, looked at now and then: others start them too. */
export function useStudies() {
  return useQuery({
    queryKey: ["studies"],
    queryFn: () => api.GET("/api/v1/studies"),
    refetchInterval: ({ state: { data } }) => (data?.studies.some(({ state }) => state === "running") ? 1000 : 4000),
  });
}

/** One study, looked at twice a second while it runs. */
export function useStudy(id: string | null) {
  return useQuery({
    queryKey: ["study", id],
    queryFn: () => api.GET("/api/v1/studies/{study}", { path: { study: id ?? "" } }),
    enabled: id !== null,
    refetchInterval: ({ state: { data } }) => (data?.state === "running" ? 500 : false),
    retry: false,
  });
}

/** What a study would do, asked anew as the form changes; of another goal or axis nothing is shown meanwhile. */
export function usePlan(wish: Wish, enabled: boolean) {
  const of = `${wish.device} ${wish.axis} ${wish.study.kind}`;
  return useQuery({
    queryKey: ["study plan", of, wish],
    queryFn: () => api.POST("/api/v1/studies/plan", { body: wish }),
    enabled,
    refetchInterval: 3000,
    placeholderData: (before, query) => (query?.queryKey[1] === of ? before : undefined),
    retry: false,
  });
}

/** Switches on or off that moves of an axis are noticed. */
export function useWatch(device: string, axis: number) {
  const queries = useQueryClient();
  const at = { path: { device, axis } };
  return useMutation({
    mutationFn: async (on: boolean): Promise<unknown> =>
      on
        ? api.PUT("/api/v1/devices/{device}/axes/{axis}/noticed-moves", at)
        : api.DELETE("/api/v1/devices/{device}/axes/{axis}/noticed-moves", at),
    onSettled: () => queries.invalidateQueries({ queryKey: ["studies"] }),
  });
}

/** What changes studies, or an axis by one. */
export function useChanges(onStarted: (id: string) => void) {
  const queries = useQueryClient();
  const onSettled = () =>
    Promise.all(
      ["studies", "study", "study plan", "devices"].map((key) => queries.invalidateQueries({ queryKey: [key] })),
    );
  const at = (study: string) => ({ path: { study } });
  return {
    start: useMutation({
      mutationFn: (wish: Wish) => api.POST("/api/v1/studies", { body: wish }),
      onSuccess: ({ id }) => onStarted(id),
      onSettled,
    }),
    stop: useMutation({ mutationFn: (id: string) => api.POST("/api/v1/studies/{study}/stop", at(id)), onSettled }),
    resume: useMutation({ mutationFn: (id: string) => api.POST("/api/v1/studies/{study}/resume", at(id)), onSettled }),
    best: useMutation({
      mutationFn: (id: string) => api.POST("/api/v1/studies/{study}/take", { ...at(id), body: { which: "best" } }),
      onSettled,
    }),
    trial: useMutation({
      mutationFn: ({ id, trial }: { id: string; trial: number }) =>
        api.POST("/api/v1/studies/{study}/take", { ...at(id), body: { which: "trial", trial } }),
      onSettled,
    }),
    undo: useMutation({
      mutationFn: (id: string) => api.POST("/api/v1/studies/{study}/take", { ...at(id), body: { which: "baseline" } }),
      onSettled,
    }),
    keep: useMutation({ mutationFn: (id: string) => api.POST("/api/v1/studies/{study}/profiles", at(id)), onSettled }),
    remove: useMutation({ mutationFn: (id: string) => api.DELETE("/api/v1/studies/{study}", at(id)), onSettled }),
  };
}

export type Changes = ReturnType<typeof useChanges>;
