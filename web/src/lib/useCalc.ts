import { useThrottledValue } from "@mantine/hooks";
import { useQuery } from "@tanstack/react-query";
import { useEffect, useState } from "react";

export interface Calculation<Result> {
  /** the latest answer; while a newer one is awaited, the one before */
  result: Result | undefined;
  /** what is shown answers an older question: show it so */
  stale: boolean;
  error: unknown;
  retry: () => void;
}

/**
 * An answer of a calculator that follows its question. While the question changes it is asked at a calm pace, the last
 * question wins (older requests are aborted), and the old answer stays until the new one is there. `null` asks nothing.
 */
export function useCalc<Body, Result>(
  name: string,
  body: Body | null,
  call: (body: Body, signal: AbortSignal) => Promise<Result>,
  paceMs = 90,
): Calculation<Result> {
  const question = body === null ? null : JSON.stringify(body);
  const asked = useThrottledValue(question, paceMs);
  const query = useQuery({
    queryKey: ["calc", name, asked],
    queryFn: ({ signal }) => call(JSON.parse(asked ?? "null") as Body, signal),
    enabled: asked !== null,
    staleTime: Number.POSITIVE_INFINITY,
    gcTime: 30_000,
  });
  const [latest, setLatest] = useState<Result | undefined>(undefined);
  useEffect(() => {
    if (query.data !== undefined) setLatest(query.data);
  }, [query.data]);
  const current = question === asked && question !== null;
  const result = query.data ?? latest;
  return {
    result,
    stale: result !== undefined && (!current || query.data === undefined),
    error: current && query.isError ? query.error : null,
    retry: () => void query.refetch(),
  };
}
