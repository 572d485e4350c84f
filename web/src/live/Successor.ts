import type { Schemas } from "../api/client";
import { lowerBound, resampled } from "../plots/series";
import { decodeFrame, type Frame } from "./frames";
import { bufferFor, type TelemetryRequest } from "./request";
import type { TraceBuffer } from "./TraceBuffer";

/** How a socket is made; tests bring their own. */
export type OpenSocket = (url: string, protocol: string) => WebSocket;

type Start = Extract<Schemas["TelemetryMessage"], { type: "start" }>;

/** The old socket is given up where it does not come as far as the new one in this time [ms]. */
const WAIT_MS = 1000;
/** The server's history of a device at rest has a sample a second: a kept row further from one has no value of it [s]. */
const PAST_REACH_S = 1.5;

/**
 * The socket that is to go on where another ends, because other channels or another rate are wanted. It collects until
 * both know the same moment; `joined` then has every row once: the kept ones up to its first live row, and its own.
 */
export class Successor {
  start: Start | null = null;
  /** what was told meanwhile: moves, stops, events */
  readonly texts: string[] = [];
  /** why the server does not send that */
  refusal: CloseEvent | null = null;
  private readonly collected: TraceBuffer;
  private pastRows = 0;
  private liveFromS = Number.NaN;
  private liveSinceMs = 0;

  constructor(
    private readonly request: TelemetryRequest,
    readonly socket: WebSocket,
    onChange: (self: Successor) => void,
  ) {
    this.collected = bufferFor(request);
    socket.onmessage = ({ data }: MessageEvent<ArrayBuffer | string>) => {
      if (typeof data === "string") this.onText(data);
      else this.onFrame(data);
      onChange(this);
    };
    socket.onclose = (event) => {
      this.refusal = event;
      onChange(this);
    };
  }

  /** Whether one that knows all up to `lastS` may end. */
  reachedBy(lastS: number): boolean {
    if (Number.isNaN(this.liveFromS)) return false;
    return lastS >= this.liveFromS || performance.now() - this.liveSinceMs > WAIT_MS;
  }

  close(): void {
    this.socket.onclose = this.socket.onmessage = null;
    this.socket.close();
  }

  /** What was kept, as far as it is still wanted, then what came here; further channels of before by the server's history. */
  joined(kept: TraceBuffer): TraceBuffer {
    const { channels } = this.request;
    const own = this.collected;
    if (!channels.some((name) => kept.column(name))) return own;
    const times = own.times();
    const live = lowerBound(times, this.liveFromS);
    const keptTimes = kept.times();
    const keptEnd = lowerBound(keptTimes, this.liveFromS);
    const before = lowerBound(times, keptTimes[0] ?? this.liveFromS);
    const past = times.subarray(0, live);
    const result = bufferFor(this.request);
    const columnOf = (name: string) => own.column(name) as Float64Array;
    const ownRows = (from: number, to: number) =>
      frameOf(
        times.subarray(from, to),
        channels.map((name) => columnOf(name).subarray(from, to)),
      );
    result.append(ownRows(0, Math.min(before, live)));
    const rows = keptTimes.subarray(0, keptEnd);
    result.append(
      frameOf(
        rows,
        channels.map(
          (name) =>
            kept.column(name)?.subarray(0, keptEnd) ??
            resampled(rows, past, columnOf(name).subarray(0, live), 0, PAST_REACH_S),
        ),
      ),
    );
    result.append(ownRows(live, times.length));
    return result;
  }

  private onText(text: string): void {
    const message: Schemas["TelemetryMessage"] = JSON.parse(text);
    if (message.type === "start") this.start = message;
    else if (message.type === "gap") this.collected.gap();
    else if (message.type !== "status") this.texts.push(text);
  }

  private onFrame(data: ArrayBuffer): void {
    const frame = decodeFrame(data);
    if (this.start && this.pastRows < this.start.history_rows) this.pastRows += frame.rows;
    else if (Number.isNaN(this.liveFromS) && frame.rows > 0) {
      this.liveFromS = frame.time[0] as number;
      this.liveSinceMs = performance.now();
    }
    this.collected.append(frame);
  }
}

function frameOf(time: Float64Array, columns: Float64Array[]): Frame {
  return { sequence: 0, rows: time.length, dropped: 0, time, columns };
}
