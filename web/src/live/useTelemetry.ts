import { useEffect, useMemo, useState, useSyncExternalStore } from "react";
import { type LinkState, type TelemetryRequest, TelemetrySource } from "./TelemetrySource";
import type { TraceBuffer } from "./TraceBuffer";

export interface Telemetry {
  buffer: TraceBuffer;
  link: LinkState;
  source: TelemetrySource;
}

/**
 * Samples of one device for as long as the component lives. Only the link's state renders; read the samples from
 * `buffer` in an animation frame, when its `revision` has changed.
 */
export function useTelemetry(device: string, channels: readonly string[], rateHz: number, keepS = 60): Telemetry {
  const key = channels.join(",");
  const source = useMemo(
    () => new TelemetrySource({ device, channels: key.split(","), rateHz, keepS }),
    [device, key, rateHz, keepS],
  );
  useEffect(() => {
    source.start();
    return () => source.stop();
  }, [source]);
  const link = useSyncExternalStore(source.subscribe, source.link);
  return { buffer: source.buffer, link, source };
}

/** The same for several devices at once, in the order asked; sources whose request stays are kept running. */
export function useTelemetries(requests: readonly TelemetryRequest[]): readonly TelemetrySource[] {
  const [running] = useState(() => new Map<string, TelemetrySource>());
  const wanted = JSON.stringify(requests);
  const sources = useMemo(
    () =>
      (JSON.parse(wanted) as TelemetryRequest[]).map((request) => {
        const key = JSON.stringify(request);
        const source = running.get(key) ?? new TelemetrySource(request);
        running.set(key, source);
        return source;
      }),
    [wanted, running],
  );
  useEffect(() => {
    for (const [key, source] of running) {
      if (sources.includes(source)) source.start();
      else {
        source.stop();
        running.delete(key);
      }
    }
  }, [sources, running]);
  useEffect(
    () => () => {
      for (const source of running.values()) source.stop();
    },
    [running],
  );
  return sources;
}

/** The link states of several sources, as one value that changes when any does. */
export function useLinks(sources: readonly TelemetrySource[]): readonly LinkState[] {
  const store = useMemo(() => {
    let snapshot = sources.map((source) => source.link());
    return {
      subscribe: (listener: () => void) => {
        const ends = sources.map((source) => source.subscribe(listener));
        return () => {
          for (const end of ends) end();
        };
      },
      read: () => {
        const next = sources.map((source) => source.link());
        if (next.some((state, index) => state !== snapshot[index])) snapshot = next;
        return snapshot;
      },
    };
  }, [sources]);
  return useSyncExternalStore(store.subscribe, store.read);
}
