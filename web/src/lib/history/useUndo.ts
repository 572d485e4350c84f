import { useInfiniteQuery, useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";
import type { Aim } from "./aim";

const LOOK_MS = 3000;
const PAGE = 40;

/** What was done to a device, the newest first, and what comes while one looks. */
export function useChanges(device: string) {
  const pages = useInfiniteQuery({
    queryKey: ["history", device],
    queryFn: ({ pageParam, signal }) =>
      api.GET("/api/v1/devices/{device}/history", {
        path: { device },
        query: { limit: PAGE, ...(pageParam > 0 && { before: pageParam }) },
        signal,
      }),
    initialPageParam: 0,
    getNextPageParam: (last) => (last.more ? last.changes.at(-1)?.first : undefined),
    refetchInterval: LOOK_MS,
    retry: false,
  });
  return { ...pages, changes: pages.data?.pages.flatMap((page) => page.changes) };
}

/** What would be put back. */
export function usePreview({ device, order }: Aim) {
  return useQuery({
    queryKey: ["undo", device, order],
    queryFn: ({ signal }) =>
      api.POST("/api/v1/devices/{device}/undo", { path: { device }, query: { dry_run: true }, body: order, signal }),
    retry: false,
    gcTime: 0,
    refetchOnWindowFocus: false,
  });
}

type Place = Schemas["PlaceIn"];

/** Puts the chosen registers back; refused where one was written since the preview. */
export function usePutBack({ device, order }: Aim) {
  const queries = useQueryClient();
  return useMutation({
    mutationFn: ({ registers, seen }: { registers: Place[]; seen: number }) =>
      api.POST("/api/v1/devices/{device}/undo", { path: { device }, body: { ...order, registers, seen } }),
    onSettled: () =>
      Promise.all(
        ["registers", "devices", "history", "profile-diff"].map((key) =>
          queries.invalidateQueries({ queryKey: key === "devices" || key === "profile-diff" ? [key] : [key, device] }),
        ),
      ),
  });
}
