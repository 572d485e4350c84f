import { useQuery } from "@tanstack/react-query";
import { useEffect, useRef, useState } from "react";
import { api } from "../../api/client";
import type { Device } from "../../api/queries";
import { append, type Frame } from "./log";

const LOOK_MS = 400;
const LIMIT = 1000;

/**
 * The device's frame log, followed while the page is open. What came between two looks and was more than one answer
 * holds, or than the server keeps, is counted as missed.
 */
export function useFrameLog(device: Device | undefined, paused: boolean) {
  const id = device?.id ?? "";
  const [frames, setFrames] = useState<readonly Frame[]>([]);
  const [missed, setMissed] = useState(0);
  const next = useRef<number | null>(null);

  // biome-ignore lint/correctness/useExhaustiveDependencies: another device's log begins anew
  useEffect(() => {
    setFrames([]);
    setMissed(0);
    next.current = null;
  }, [id]);

  const look = useQuery({
    queryKey: ["frames", id],
    queryFn: async ({ signal }) => {
      const first = next.current === null;
      const page = await api.GET("/api/v1/devices/{device}/frames", {
        path: { device: id },
        query: { after: next.current ?? 0, limit: LIMIT },
        signal,
      });
      // Numbers start again with a new connection.
      const anew = next.current !== null && page.next < next.current;
      next.current = anew ? null : page.next;
      setFrames((now) => append(anew ? [] : now, page.frames));
      if (!first && !anew && page.lost > 0) setMissed((count) => count + page.lost);
      return page.next;
    },
    enabled: device !== undefined && !paused,
    refetchInterval: LOOK_MS,
    staleTime: 0,
    gcTime: 0,
  });
  return {
    frames,
    missed,
    error: look.error,
    pending: look.isPending && !paused,
    clear: () => {
      setFrames([]);
      setMissed(0);
    },
  };
}
