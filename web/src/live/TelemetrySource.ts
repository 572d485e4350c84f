import type { Schemas } from "../api/client";
import { decodeFrame } from "./frames";
import { TraceBuffer } from "./TraceBuffer";

export interface TelemetryRequest {
  device: string;
  channels: readonly string[];
  rateHz: number;
  /** what the page keeps, and asks back for after a reload [s] */
  keepS: number;
}

export type LinkPhase = "connecting" | "live" | "gap" | "lost" | "refused";

/** What is known of a telemetry link: the only part of it that React renders. */
export interface LinkState {
  phase: LinkPhase;
  requestedRateHz: number;
  /** what the server granted */
  rateHz: number | null;
  achievedRateHz: number | null;
  jitterMs: number | null;
  latencyMs: number | null;
  /** questions on the wire a second, and how many it carries; null where there is no such limit */
  callsPerS: number | null;
  callsPerSPossible: number | null;
  /** how far apart the first and the last question of a row are: its columns are not quite of one moment */
  rowSpreadMs: number | null;
  dropped: number;
  /** samples bear the device's own time */
  chipTimed: boolean;
  /** unix time of device time 0 [s] */
  timeOriginUnixS: number | null;
  units: Readonly<Record<string, string>>;
  /** why nothing comes */
  reason: string | null;
  /** seconds until the next attempt */
  retryInS: number | null;
}

type Message = Schemas["TelemetryMessage"];
type Of<Type extends Message["type"]> = Extract<Message, { type: Type }>;
/** What is told at the moment it was noticed: times are the device's own, those of the samples. */
type Told = "move" | "stopped" | "event";

/** How a socket is made; tests bring their own. */
export type OpenSocket = (url: string, protocol: string) => WebSocket;

const PROTOCOL = "stepscope.telemetry.v1";
const FIRST_RETRY_S = 0.25;
const LAST_RETRY_S = 5;
/** More would be 100 MB of columns in the page; a recording is the place for longer runs. */
const MOST_ROWS = 150_000;
const PROGRAM_MARKS = 200;

function initialState(request: TelemetryRequest): LinkState {
  return {
    phase: "connecting",
    requestedRateHz: request.rateHz,
    rateHz: null,
    achievedRateHz: null,
    jitterMs: null,
    latencyMs: null,
    callsPerS: null,
    callsPerSPossible: null,
    rowSpreadMs: null,
    dropped: 0,
    chipTimed: false,
    timeOriginUnixS: null,
    units: {},
    reason: null,
    retryInS: null,
  };
}

export function telemetryUrl(request: TelemetryRequest, origin: string): string {
  const url = new URL(`/api/v1/devices/${encodeURIComponent(request.device)}/telemetry`, origin);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  url.searchParams.set("channels", request.channels.join(","));
  url.searchParams.set("rate_hz", String(request.rateHz));
  url.searchParams.set("history_s", String(request.keepS));
  return url.href;
}

/**
 * The samples of one device: a socket that comes back by itself, and the buffer that it fills. Made to live outside of
 * React: `subscribe` tells of the link's state (at most about once a second), `buffer.revision` of the samples.
 */
export class TelemetrySource {
  readonly request: TelemetryRequest;
  readonly buffer: TraceBuffer;
  /** what the device's program did, the latest last; a new array where it is another */
  program: readonly Of<"program">[] = [];
  private socket: WebSocket | null = null;
  private state: LinkState;
  private retryS = FIRST_RETRY_S;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private closed = true;
  private readonly listeners = new Set<() => void>();
  private readonly told: { [Type in Told]: Set<(message: Of<Type>) => void> } = {
    move: new Set(),
    stopped: new Set(),
    event: new Set(),
  };
  private readonly open: OpenSocket;

  constructor(request: TelemetryRequest, open: OpenSocket = (url, protocol) => new WebSocket(url, protocol)) {
    this.request = request;
    this.open = open;
    this.state = initialState(request);
    const rows = Math.ceil(request.keepS * request.rateHz * 1.05) + 64;
    this.buffer = new TraceBuffer(request.channels, Math.min(MOST_ROWS, rows));
  }

  /** Connect, and stay so until `stop`. A second start does nothing. */
  start(): void {
    if (!this.closed) return;
    this.closed = false;
    this.connect();
  }

  stop(): void {
    this.closed = true;
    clearTimeout(this.timer);
    const socket = this.socket;
    this.socket = null;
    if (socket) {
      socket.onclose = socket.onmessage = socket.onerror = null;
      socket.close();
    }
  }

  link = (): LinkState => this.state;

  subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  /** Hear of every move, stop or event of the chip as it is told; the answer ends that. */
  on<Type extends Told>(type: Type, listener: (message: Of<Type>) => void): () => void {
    this.told[type].add(listener);
    return () => this.told[type].delete(listener);
  }

  private update(change: Partial<LinkState>): void {
    this.state = { ...this.state, ...change };
    for (const listener of this.listeners) listener();
  }

  private connect(): void {
    if (this.closed) return;
    const socket = this.open(telemetryUrl(this.request, window.location.origin), PROTOCOL);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }: MessageEvent<ArrayBuffer | string>) => {
      if (typeof data === "string") this.onText(data);
      else this.onFrame(data);
    };
    socket.onclose = (event) => this.onClose(event);
  }

  private onFrame(data: ArrayBuffer): void {
    const frame = decodeFrame(data);
    // Rows that the server had to drop are missing between the last frame and this one.
    if (frame.dropped > this.state.dropped) {
      this.buffer.gap();
      this.update({ dropped: frame.dropped });
    }
    this.buffer.append(frame);
    if (this.state.phase !== "live") this.update({ phase: "live", reason: null });
  }

  private onText(text: string): void {
    const message: Message = JSON.parse(text);
    switch (message.type) {
      case "start":
        // The history that follows is complete: what was kept before the break is part of it.
        this.buffer.clear();
        this.program = [];
        this.retryS = FIRST_RETRY_S;
        this.update({
          phase: "live",
          reason: null,
          retryInS: null,
          dropped: 0,
          rateHz: message.rate_hz,
          chipTimed: message.chip_timed,
          timeOriginUnixS: message.time_origin_unix_s,
          units: Object.fromEntries(message.channels.map(({ name, unit }) => [name, unit])),
        });
        break;
      case "status":
        this.update({
          achievedRateHz: message.achieved_rate_hz,
          jitterMs: message.jitter_ms,
          latencyMs: message.latency_ms,
          callsPerS: message.calls_per_s,
          callsPerSPossible: message.calls_per_s_possible,
          rowSpreadMs: message.row_spread_ms,
        });
        break;
      case "gap":
        this.buffer.gap();
        this.update({ phase: "gap", reason: message.reason });
        break;
      case "move":
        for (const listener of this.told.move) listener(message);
        break;
      case "stopped":
        for (const listener of this.told.stopped) listener(message);
        break;
      case "program":
        this.program = [...this.program, message].slice(-PROGRAM_MARKS);
        break;
      case "event":
        for (const listener of this.told.event) listener(message);
        break;
    }
  }

  private onClose(event: CloseEvent): void {
    if (this.closed) return;
    this.buffer.gap();
    const refused = event.code >= 4000 || event.code === 1008;
    const wait = this.retryS * (0.8 + 0.4 * Math.random()); // so that many pages do not come back in step
    this.update({
      phase: refused ? "refused" : "lost",
      reason: event.reason || (refused ? "The server refused the channels" : "The connection to the server is lost"),
      retryInS: wait,
      achievedRateHz: null,
      callsPerS: null,
    });
    this.retryS = Math.min(LAST_RETRY_S, this.retryS * 2);
    this.timer = setTimeout(() => this.connect(), wait * 1000);
  }
}
