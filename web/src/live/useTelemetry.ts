import { useEffect, useMemo, useSyncExternalStore } from "react";
import { hub } from "./hub";
import type { TelemetryRequest } from "./request";
import type { LinkState, TelemetrySource } from "./TelemetrySource";
import type { TraceBuffer } from "./TraceBuffer";

export interface Telemetry {
  /** of this rendering: another one takes its place when something else on the page wants more of the device */
  buffer: TraceBuffer;
  link: LinkState;
  source: TelemetrySource;
}

/**
 * Samples of one device for as long as the component lives. Only the link's state renders; read the samples from
 * `buffer` in an animation frame, when its `revision` has changed. There may be more channels in it, more rows and older
 * ones: it is the one buffer of the device, for all that reads it.
 */
export function useTelemetry(device: string, channels: readonly string[], rateHz: number, keepS = 60): Telemetry {
  const key = channels.join(",");
  const source = hub.sourceOf(device);
  useEffect(() => hub.want({ device, channels: key.split(","), rateHz, keepS }), [device, key, rateHz, keepS]);
  const link = useSyncExternalStore(source.subscribe, source.link);
  return { buffer: source.buffer, link, source };
}

/** The same for several devices at once, in the order asked. */
export function useTelemetries(requests: readonly TelemetryRequest[]): readonly TelemetrySource[] {
  const wanted = JSON.stringify(requests);
  useEffect(() => {
    const ends = (JSON.parse(wanted) as TelemetryRequest[]).map((request) => hub.want(request));
    return () => {
      for (const end of ends) end();
    };
  }, [wanted]);
  const devices = requests.map(({ device }) => device).join("\n");
  return useMemo(() => (devices === "" ? [] : devices.split("\n").map((device) => hub.sourceOf(device))), [devices]);
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
