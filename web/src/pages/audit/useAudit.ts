import { keepPreviousData, useInfiniteQuery, useQuery, useQueryClient } from "@tanstack/react-query";
import { useMemo } from "react";
import { api, type Schemas } from "../../api/client";
import type { Entry, Query } from "./filters";

const PAGE = 100;
const LOOK_MS = 1500;
/** More news than that, and everything is asked for again. */
const NEWS_MAX = 500;
/** A browser draws no more rows than that in one go without being felt. */
export const SHOWN_MAX = 3000;

async function ask(
  query: Query,
  more: { before?: number; after?: number; limit: number },
  signal: AbortSignal,
): Promise<Schemas["AuditPage"]> {
  // the schema knows a file as another answer, which only `format` asks for
  const answer = await api.GET("/api/v1/audit", { query: { ...query, ...more } as never, signal });
  return answer as unknown as Schemas["AuditPage"];
}

export interface Audit {
  /** the newest first; undefined before the first answer */
  entries: Entry[] | undefined;
  /** entries that have come since the page was asked for, the newest first */
  news: Entry[];
  error: unknown;
  /** what is shown answers an earlier question */
  asking: boolean;
  /** what is shown may be old: the server does not answer */
  stale: boolean;
  /** there are older ones */
  more: boolean;
  loadingMore: boolean;
  older: () => void;
  /** ask for everything again */
  again: () => void;
}

/** The log as far as it was asked for, and what has come since. */
export function useAudit(query: Query): Audit {
  const queries = useQueryClient();
  const pages = useInfiniteQuery({
    queryKey: ["audit", "pages", query],
    queryFn: ({ pageParam, signal }) => ask(query, { limit: PAGE, ...(pageParam && { before: pageParam }) }, signal),
    initialPageParam: 0,
    getNextPageParam: (last) => (last.more ? last.entries.at(-1)?.id : undefined),
    refetchOnWindowFocus: false,
    staleTime: Number.POSITIVE_INFINITY,
    gcTime: 0, // who comes back wants to see what is there now
    placeholderData: keepPreviousData,
    retry: false,
  });
  const known = pages.data?.pages.flatMap((page) => page.entries);
  const newest = pages.isPlaceholderData ? undefined : (known?.[0]?.id ?? (known && 0));
  const news = useQuery({
    queryKey: ["audit", "news", query, newest],
    queryFn: async ({ signal }) => {
      const found = await ask(query, { after: newest ?? 0, limit: NEWS_MAX }, signal);
      if (found.more) void queries.resetQueries({ queryKey: ["audit", "pages", query] });
      return found.entries;
    },
    enabled: newest !== undefined,
    refetchInterval: LOOK_MS,
    gcTime: 0,
    retry: false,
  });
  return {
    entries: known,
    news: news.data ?? [],
    error: pages.error,
    asking: pages.isPlaceholderData,
    stale: news.isError,
    more: pages.hasNextPage && (known?.length ?? 0) < SHOWN_MAX,
    loadingMore: pages.isFetchingNextPage,
    older: () => {
      if (!pages.isFetchingNextPage) void pages.fetchNextPage();
    },
    again: () => void pages.refetch(),
  };
}

/** Names to filter by. */
export function useAuditFilters() {
  const query = useQuery({
    queryKey: ["audit", "filters"],
    queryFn: () => api.GET("/api/v1/audit/filters"),
    refetchInterval: 10_000,
  });
  return useMemo(() => query.data ?? { devices: [], who: [], actions: [] }, [query.data]);
}
