import type { TelemetryRequest } from "./request";
import { TelemetrySource } from "./TelemetrySource";

/** How long what nobody wants any more goes on: the next page may want it again [ms]. */
const RELEASED_AFTER_MS = 2000;
/** What one socket of the server carries (docs/limits.md); the latest wishes beyond that are left out. */
const CHANNELS_MAX = 128;

interface Entry {
  source: TelemetrySource;
  wishes: Set<TelemetryRequest>;
  timer: ReturnType<typeof setTimeout> | undefined;
  /** it is to be looked at when all that is rendered now has said what it wants */
  queued: boolean;
}

/** The one request that has what all of them ask for. */
export function joined(device: string, wishes: Iterable<TelemetryRequest>): TelemetryRequest {
  const all = [...wishes];
  const channels = [...new Set(all.flatMap((wish) => wish.channels))].slice(0, CHANNELS_MAX).sort();
  return {
    device,
    channels,
    rateHz: Math.max(1, ...all.map(({ rateHz }) => rateHz)),
    keepS: Math.max(1, ...all.map(({ keepS }) => keepS)),
  };
}

function has(request: TelemetryRequest, wanted: TelemetryRequest): boolean {
  return (
    wanted.rateHz <= request.rateHz &&
    wanted.keepS <= request.keepS &&
    wanted.channels.every((name) => request.channels.includes(name))
  );
}

/**
 * One source a device for everything on the page that reads its samples: the union of their channels at the highest of
 * their rates, kept for the longest of their times.
 */
export class TelemetryHub {
  private readonly entries = new Map<string, Entry>();

  constructor(private readonly make = (request: TelemetryRequest) => new TelemetrySource(request)) {}

  /** The source of a device, the same one for ever; it runs while anybody wants something of it. */
  sourceOf(device: string): TelemetrySource {
    return this.entry(device).source;
  }

  /** Have these samples in the device's source until the answer is called. */
  want(request: TelemetryRequest): () => void {
    const entry = this.entry(request.device);
    const wish = { ...request };
    entry.wishes.add(wish);
    this.settleSoon(entry);
    return () => {
      entry.wishes.delete(wish);
      this.settleSoon(entry);
    };
  }

  private entry(device: string): Entry {
    const known = this.entries.get(device);
    if (known) return known;
    const entry = {
      source: this.make(joined(device, [])),
      wishes: new Set<TelemetryRequest>(),
      timer: undefined,
      queued: false,
    };
    this.entries.set(device, entry);
    return entry;
  }

  private settleSoon(entry: Entry): void {
    if (entry.queued) return;
    entry.queued = true;
    queueMicrotask(() => {
      entry.queued = false;
      this.settle(entry);
    });
  }

  private settle(entry: Entry): void {
    clearTimeout(entry.timer);
    const { source } = entry;
    const wanted = joined(source.request.device, entry.wishes);
    if (entry.wishes.size > 0 && !has(source.request, wanted)) {
      source.change(wanted);
      source.start();
      return;
    }
    if (entry.wishes.size > 0) source.start();
    entry.timer = setTimeout(() => {
      if (entry.wishes.size === 0) source.stop();
      source.change(wanted);
    }, RELEASED_AFTER_MS);
  }
}

export const hub = new TelemetryHub();
