import { useQuery } from "@tanstack/react-query";
import { useEffect, useMemo, useRef, useState } from "react";
import { api, type Schemas } from "../../api/client";
import { type Device, useCatalogModel } from "../../api/queries";
import { familyOf } from "../../families/families";
import type { TelemetrySource } from "../../live/TelemetrySource";
import { useFrame } from "../../live/useFrame";
import { EventLog, type Lane, lanesOf } from "./EventLog";

const POLL_MS = 2000;
const PAGE = 2000;
/** Rows and counts need not be newer than this; the marks themselves are drawn in every frame. */
const LOOK_MS = 150;

export interface EventBit {
  name: string;
  help: string;
}

/** The bits of those registers with their meanings, from the catalog. */
export function useEventBits(device: Device): readonly EventBit[] {
  const catalog = useCatalogModel(device.model);
  return useMemo(() => {
    const family = familyOf(device);
    return (family?.events ?? []).flatMap((register) =>
      bitsOf(catalog.data?.rows ?? [], register).map((bit) => ({
        ...bit,
        name: family?.eventNames?.[bit.name] ?? bit.name,
      })),
    );
  }, [catalog.data, device]);
}

/** The registers of its events that this very model has, as its data sheet spells them. */
export function useEventRegisters(device: Device): readonly string[] {
  const catalog = useCatalogModel(device.model);
  const rows = catalog.data?.rows ?? [];
  return (familyOf(device)?.events ?? []).filter((register) => rows.some((row) => row.name === register));
}

function bitsOf(rows: readonly Schemas["RegisterRow"][], register: string): EventBit[] {
  // of two axes one stands for both
  const row = rows.find((candidate) => candidate.name === register);
  return row?.fields.map(({ name, help }) => ({ name, help })) ?? [];
}

/** The timeline of one axis, from the server's memory and live from the socket of `source`. */
export function useEvents(of: Device, axis: number, source: TelemetrySource | undefined, enabled: boolean) {
  const device = of.id;
  // biome-ignore lint/correctness/useExhaustiveDependencies: another axis has another timeline
  const log = useMemo(() => new EventLog(), [device, axis]);
  const bits = useEventBits(of);
  const query = useQuery({
    queryKey: ["events", device, axis],
    queryFn: async ({ signal }) => {
      for (;;) {
        const page = await api.GET("/api/v1/devices/{device}/axes/{axis}/events", {
          path: { device, axis },
          query: { after: log.asked, limit: PAGE },
          signal,
        });
        const again = page.next < log.asked;
        log.page(
          page.events.map((event) => ({
            seq: event.seq,
            timeS: event.time_s,
            unixS: event.unix_s,
            names: event.names,
          })),
          page.next,
          page.lost,
        );
        if (!again && page.events.length < PAGE) return log.asked;
      }
    },
    enabled,
    refetchInterval: POLL_MS,
    staleTime: 0,
    gcTime: 0,
  });
  useEffect(
    () =>
      source?.on("event", (event) => {
        if (event.axis === axis) log.add([{ seq: event.seq, timeS: event.time_s, unixS: null, names: event.names }]);
      }),
    [source, log, axis],
  );

  const [seen, setSeen] = useState({ log, revision: 0 });
  const lookedMs = useRef(0);
  useFrame((nowMs) => {
    if (nowMs - lookedMs.current < LOOK_MS) return;
    lookedMs.current = nowMs;
    setSeen((now) => (now.log === log && now.revision === log.revision ? now : { log, revision: log.revision }));
  });
  const names = useMemo(() => bits.map((bit) => bit.name), [bits]);
  const lanes = useMemo((): Lane[] => (seen.log === log ? lanesOf(log.entries, names) : []), [seen, log, names]);
  return { log, lanes, bits, query };
}

export type Events = ReturnType<typeof useEvents>;
