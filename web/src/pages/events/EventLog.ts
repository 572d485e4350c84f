/** What was new at one look at the event register. */
export interface EventEntry {
  seq: number;
  /** device time, that of the samples [s] */
  timeS: number;
  /** null where only the socket has told of it yet [s] */
  unixS: number | null;
  names: readonly string[];
}

/** As many as the server keeps. */
const KEPT = 2000;

/**
 * The events of one axis as far as this page knows them, by number. They come twice, at once by the socket and now and
 * then by REST, which also brings what was before the page and what a broken socket has missed.
 */
export class EventLog {
  /** rising by `seq` */
  entries: readonly EventEntry[] = [];
  /** counts changes: draw again when it differs from the one drawn */
  revision = 0;
  /** entries that the server had forgotten before this page asked */
  lost = 0;
  /** up to here REST has told everything */
  asked = 0;

  add(news: readonly EventEntry[]): void {
    if (news.length === 0) return;
    const known = new Map(this.entries.map((entry) => [entry.seq, entry]));
    let changed = false;
    for (const entry of news) {
      const before = known.get(entry.seq);
      if (before !== undefined && (before.unixS !== null || entry.unixS === null)) continue;
      known.set(entry.seq, entry);
      changed = true;
    }
    if (!changed) return;
    this.entries = [...known.values()].sort((a, b) => a.seq - b.seq).slice(-KEPT);
    this.revision += 1;
  }

  /** A page of REST: what it brings, and up to where that is all. A `next` below what was asked is another timeline. */
  page(news: readonly EventEntry[], next: number, lost: number): void {
    if (next < this.asked) this.clear();
    this.lost += lost;
    this.asked = Math.max(this.asked, next);
    this.add(news);
  }

  clear(): void {
    this.entries = [];
    this.asked = 0;
    this.lost = 0;
    this.revision += 1;
  }
}

/** One line of the timeline: an event bit that occurred. */
export interface Lane {
  name: string;
  /** rising times of it [s] */
  times: readonly number[];
  /** numbers of the entries at these times */
  seqs: readonly number[];
}

/** A lane for each bit that occurred, in the order of `bits`; names that it does not have come last. */
export function lanesOf(entries: readonly EventEntry[], bits: readonly string[]): Lane[] {
  const lanes = new Map<string, { times: number[]; seqs: number[] }>();
  for (const entry of entries)
    for (const name of entry.names) {
      const lane = lanes.get(name) ?? { times: [], seqs: [] };
      lane.times.push(entry.timeS);
      lane.seqs.push(entry.seq);
      lanes.set(name, lane);
    }
  const place = (name: string) => (bits.includes(name) ? bits.indexOf(name) : bits.length);
  return [...lanes]
    .map(([name, lane]) => ({ name, ...lane }))
    .sort((a, b) => place(a.name) - place(b.name) || a.name.localeCompare(b.name));
}

/** The mark nearest to a time in one lane, within `reach` [s]; the later one of two equally near. */
export function nearest(lane: Lane | undefined, time: number, reach: number): number | null {
  if (lane === undefined) return null;
  let found: number | null = null;
  let best = reach;
  lane.times.forEach((at, index) => {
    if (Math.abs(at - time) > best) return;
    best = Math.abs(at - time);
    found = index;
  });
  return found;
}

/** Faults among the events: these are red, and a diamond. */
const FAULTS: ReadonlySet<string> = new Set([
  "HOME_ERROR",
  "ENC_FAIL",
  "SER_ENC_DATA_FAIL",
  "STOP_ON_STALL",
  "FROZEN",
  "event_stop_sg",
  "drv_err",
  "drv_err1",
  "drv_err2",
  "uv_cp",
  "INT_REF_WRONG",
  "int_ref_wrong",
  "INT_REF_MISS",
  "int_ref_miss",
]);

export function isFault(name: string): boolean {
  return FAULTS.has(name);
}
