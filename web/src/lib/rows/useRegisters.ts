import { useQuery } from "@tanstack/react-query";
import { useEffect, useMemo, useRef, useState } from "react";
import { api, type Schemas } from "../../api/client";
import { type Device, useCatalogModel } from "../../api/queries";
import { type Key, keyOf } from "./staging";

export type Reading = Schemas["RegisterReading"];

/** Three looks a second: fast enough to follow a motor, slow enough for every link. */
const POLL_MS = 320;
const OLD_MS = 2000;

export type Live = ReturnType<typeof useRegisters>;

/**
 * Catalog and live readings of a device, all registers in one look, or those of some groups; with `kept` also what the
 * server knows of those that cannot be read, marked so. A hidden page does not poll, and a slow link is asked half of
 * its time at most.
 */
export function useRegisters(
  device: Device | undefined,
  paused: boolean,
  groups: readonly string[] | null = null,
  kept = false,
) {
  const catalog = useCatalogModel(device?.model);
  const tookMs = useRef(0);
  const connected = device?.state === "connected";
  const id = device?.id ?? "";
  const readings = useQuery({
    queryKey: ["registers", id, ...(groups === null ? [] : [groups]), ...(kept ? ["kept"] : [])],
    queryFn: async ({ signal }) => {
      const asked = performance.now();
      const answer = await api.GET("/api/v1/devices/{device}/registers", {
        path: { device: id },
        query: { ...(groups === null ? {} : { group: [...groups] }), kept },
        signal,
      });
      tookMs.current = performance.now() - asked;
      return answer;
    },
    enabled: connected && groups?.length !== 0,
    // What this device showed stays until other groups of it are read; another device's values never do.
    placeholderData: (before, query) => (query?.queryKey[1] === id ? before : undefined),
    refetchInterval: paused ? false : () => Math.max(POLL_MS, 2 * tookMs.current),
    staleTime: 0,
    gcTime: 60_000,
  });

  const byKey = useMemo(() => {
    const map = new Map<Key, Reading>();
    for (const reading of readings.data ?? []) map.set(keyOf(reading), reading);
    return map;
  }, [readings.data]);

  const ageMs = useAge(readings.dataUpdatedAt);
  return {
    catalog,
    readings,
    byKey,
    connected,
    ageMs,
    /** what is shown may no longer be so */
    old: readings.data !== undefined && ageMs >= OLD_MS,
  };
}

/** How long ago that was, in steps of a second from two seconds on: below, a page need not know. */
function useAge(since: number): number {
  const [age, setAge] = useState(0);
  useEffect(() => {
    const look = () => {
      const passed = since === 0 ? 0 : Date.now() - since;
      setAge(passed < OLD_MS ? 0 : Math.floor(passed / 1000) * 1000);
    };
    look();
    const timer = setInterval(look, 500);
    return () => clearInterval(timer);
  }, [since]);
  return age;
}
