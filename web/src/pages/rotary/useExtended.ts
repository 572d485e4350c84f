import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useMemo } from "react";
import { api } from "../../api/client";
import type { AxisAddress } from "../../api/motion";
import { type Answer, type Change, compareCount, extendedOf, ROUTE } from "./extended";

/** A few times a second while the page is seen; the digits between come from the samples. */
const PERIOD_MS = 300;
const COMPARE_PERIOD_MS = 3000;

/** Where an axis is beyond its counter, and what changes that. */
export function useExtended({ device, axis }: AxisAddress, enabled: boolean) {
  const queries = useQueryClient();
  const key = useMemo(() => ["extended-position", device, axis], [device, axis]);
  const params = { path: { device, axis } };
  const query = useQuery({
    queryKey: key,
    queryFn: () => api.GET(ROUTE, params),
    enabled,
    refetchInterval: PERIOD_MS,
    retry: false,
  });
  const settled = (answer: Answer) => {
    // an answer that was asked for before the change must not come after it
    void queries.cancelQueries({ queryKey: key });
    queries.setQueryData(key, answer);
    void queries.invalidateQueries({ queryKey: ["extended-history", device, axis] });
  };
  const change = useMutation({
    mutationFn: (body: Change) => api.PUT(ROUTE, { ...params, body }),
    onSuccess: settled,
  });
  const forget = useMutation({
    mutationFn: () => api.DELETE(ROUTE, params),
    onSuccess: settled,
  });
  const seen = useMemo(() => (query.data ? extendedOf(query.data) : null), [query.data]);
  return { query, seen, change, forget };
}

export type ExtendedAxis = ReturnType<typeof useExtended>;

/**
 * Where the axis' compare register tells, as its counter counts; null where it does not. Asked for once, and again and
 * again only while a compare is armed: its place moves with the counter. One that is armed on this page is known at once.
 */
export function useCompareCount({ device, axis }: AxisAddress): number | null {
  const query = useQuery({
    queryKey: ["extended-position", device, axis],
    queryFn: () => api.GET(ROUTE, { path: { device, axis } }),
    refetchInterval: (asked) => (asked.state.data?.compare?.armed === true ? COMPARE_PERIOD_MS : false),
    retry: false,
  });
  return query.data ? compareCount(query.data) : null;
}

/** What was seen of it in the last `seconds`; asked for less often the longer that is. */
export function useHistory({ device, axis }: AxisAddress, seconds: number, enabled: boolean) {
  return useQuery({
    queryKey: ["extended-history", device, axis, seconds],
    queryFn: () => api.GET(`${ROUTE}/history`, { path: { device, axis }, query: { seconds } }),
    enabled,
    refetchInterval: Math.max(2000, seconds * 2),
    retry: false,
  });
}
