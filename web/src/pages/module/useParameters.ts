import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useCallback, useEffect, useState } from "react";
import { ApiError, api } from "../../api/client";
import type { AxisAddress } from "../../api/motion";
import { readBackNotes } from "./staged";

const POLL_MS = 3000;

/**
 * Some parameters of one axis: what the module holds, looked at now and then, and changes that wait for `apply`. What
 * was applied is what the module says afterwards; where that is not what was asked, a note says so.
 */
export function useParameters(at: AxisAddress, names: readonly string[], connected: boolean) {
  const queries = useQueryClient();
  const { device, axis } = at;
  const key = ["parameters", device, axis, names.join()];
  const [staged, setStaged] = useState<ReadonlyMap<string, number>>(new Map());
  const [notes, setNotes] = useState<readonly string[]>([]);

  // biome-ignore lint/correctness/useExhaustiveDependencies: what was staged for another device is not for this one
  useEffect(() => {
    setStaged(new Map());
    setNotes([]);
  }, [device, axis]);

  const readings = useQuery({
    queryKey: key,
    queryFn: async ({ signal }) => {
      const found: [string, number][] = [];
      // one after the other: a slow line carries the samples between them
      for (const name of names) {
        const reading = await api.GET("/api/v1/devices/{device}/registers/{name}", {
          path: { device, name },
          query: { axis },
          signal,
        });
        found.push([name, reading.value]);
      }
      return new Map(found);
    },
    enabled: connected,
    refetchInterval: POLL_MS,
  });

  const write = useMutation({
    mutationFn: async (values: ReadonlyMap<string, number>) => {
      const result = await api.POST("/api/v1/devices/{device}/registers", {
        path: { device },
        body: { writes: [...values].map(([name, value]) => ({ name, axis, value })) },
      });
      const done = new Map(result.done.map((written) => [written.name, written.value]));
      queries.setQueryData<Map<string, number>>(key, (old) => (old ? new Map([...old, ...done]) : old));
      setNotes(readBackNotes(values, result.done));
      setStaged((now) => new Map([...now].filter(([name, value]) => !(done.has(name) && values.get(name) === value))));
      if (result.failed) throw new ApiError(result.failed);
    },
    onSettled: () => queries.invalidateQueries({ queryKey: ["parameters", device] }),
  });

  const held = readings.data;
  const stage = useCallback(
    (name: string, value: number) =>
      setStaged((now) => {
        const next = new Map(now);
        if (held?.get(name) === value) next.delete(name);
        else next.set(name, value);
        return next;
      }),
    [held],
  );

  return {
    /** what the module holds; null while unknown */
    held: (name: string): number | null => (connected ? (held?.get(name) ?? null) : null),
    /** the same, with what is staged in its place */
    planned: (name: string): number | null => staged.get(name) ?? held?.get(name) ?? null,
    staged,
    stage,
    discard: () => setStaged(new Map()),
    apply: () => write.mutate(staged),
    /** without staging: what acts at once, such as a counter */
    writeNow: (values: ReadonlyMap<string, number>) => write.mutateAsync(values),
    applying: write.isPending,
    error: write.error ?? readings.error,
    dismiss: () => {
      write.reset();
      setNotes([]);
    },
    notes,
    known: held !== undefined,
  };
}

export type Parameters = ReturnType<typeof useParameters>;
