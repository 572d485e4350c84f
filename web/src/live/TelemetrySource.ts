import type { Schemas } from "../api/client";
import { decodeFrame, type Frame } from "./frames";
import { bufferFor, type TelemetryRequest, telemetryUrl } from "./request";
import { type OpenSocket, Successor } from "./Successor";
import type { TraceBuffer } from "./TraceBuffer";

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

const PROTOCOL = "stepscope.telemetry.v1";
const FIRST_RETRY_S = 0.25;
const LAST_RETRY_S = 5;
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

/**
 * The samples of one device: a socket that comes back by itself, and the buffer that it fills. Made to live outside of
 * React: `subscribe` tells of the link's state (at most about once a second), `buffer.revision` of the samples. When it is
 * asked for something else, the buffer is another one as soon as that comes, and goes on without a hole.
 */
export class TelemetrySource {
  request: TelemetryRequest;
  buffer: TraceBuffer;
  /** what the device's program did, the latest last; a new array where it is another */
  program: readonly Of<"program">[] = [];
  private socket: WebSocket | null = null;
  private next: Successor | null = null;
  /** the history of a new socket, and how many rows of it are still to come */
  private past: { buffer: TraceBuffer; missing: number } | null = null;
  /** texts that both sockets of a change tell, and only the first of them is to be heard */
  private readonly heard = new Set<string>();
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
    this.buffer = bufferFor(request);
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
    this.hangUp();
    this.update(initialState(this.request));
  }

  /** Ask for something else from now on. While samples come they go on coming: the new socket takes over from the old. */
  change(request: TelemetryRequest): void {
    if (JSON.stringify(request) === JSON.stringify(this.request)) return;
    const live = this.state.phase === "live" && !Number.isNaN(this.buffer.lastTime);
    this.request = request;
    this.next?.close();
    this.next = null;
    this.heard.clear();
    if (this.closed) this.buffer = bufferFor(request);
    else if (live) this.next = new Successor(request, this.dial(), (next) => this.takeOver(next));
    else {
      clearTimeout(this.timer);
      this.hangUp();
      this.connect();
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

  private dial(): WebSocket {
    const socket = this.open(telemetryUrl(this.request, window.location.origin), PROTOCOL);
    socket.binaryType = "arraybuffer";
    return socket;
  }

  private hangUp(): void {
    this.next?.close();
    this.next = null;
    this.past = null;
    this.heard.clear();
    close(this.socket);
    this.socket = null;
  }

  private connect(): void {
    if (this.closed) return;
    this.listen(this.dial());
  }

  private listen(socket: WebSocket): void {
    this.socket = socket;
    socket.onmessage = ({ data }: MessageEvent<ArrayBuffer | string>) => {
      if (typeof data === "string") this.onText(data);
      else this.onFrame(data);
    };
    socket.onclose = (event) => this.onClose(event);
  }

  /** The successor has come: where both have the same moment, the old socket ends and the new one goes on. */
  private takeOver(next: Successor): void {
    if (next !== this.next) return;
    if (next.refusal) {
      this.next = null;
      close(this.socket);
      this.onClose(next.refusal);
      return;
    }
    const { start } = next;
    if (!start || !next.reachedBy(this.buffer.lastTime)) return;
    this.next = null;
    close(this.socket);
    this.buffer = next.joined(this.buffer);
    this.listen(next.socket);
    this.started(start);
    for (const text of next.texts) this.onText(text);
  }

  private onFrame(data: ArrayBuffer): void {
    const frame = decodeFrame(data);
    // Rows that the server had to drop are missing between the last frame and this one.
    if (frame.dropped > this.state.dropped) {
      this.buffer.gap();
      this.update({ dropped: frame.dropped });
    }
    if (this.past) this.onPast(this.past, frame);
    else this.buffer.append(frame);
    if (this.next) this.takeOver(this.next);
    if (this.state.phase !== "live") this.update({ phase: "live", reason: null });
  }

  /** Nobody sees half of it: whoever counts rows would take its end for the present, and count the rest anew. */
  private onPast(past: { buffer: TraceBuffer; missing: number }, frame: Frame): void {
    past.buffer.append(frame);
    past.missing -= frame.rows;
    if (past.missing > 0) return;
    this.buffer = past.buffer;
    this.past = null;
  }

  private started(message: Of<"start">): void {
    this.retryS = FIRST_RETRY_S;
    this.update({
      phase: "live",
      reason: null,
      retryInS: null,
      dropped: 0,
      requestedRateHz: message.requested_rate_hz,
      rateHz: message.rate_hz,
      chipTimed: message.chip_timed,
      timeOriginUnixS: message.time_origin_unix_s,
      units: Object.fromEntries(message.channels.map(({ name, unit }) => [name, unit])),
    });
  }

  private onText(text: string): void {
    const message: Message = JSON.parse(text);
    if (this.heard.delete(text)) return;
    if (this.next && message.type !== "status" && message.type !== "gap") this.heard.add(text);
    switch (message.type) {
      case "start":
        // The history that follows is complete: what was kept before the break is part of it.
        if (message.history_rows > 0) this.past = { buffer: bufferFor(this.request), missing: message.history_rows };
        else this.buffer = bufferFor(this.request);
        this.program = [];
        this.heard.clear();
        this.started(message);
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
        if (this.next) {
          // nothing goes on without a hole now
          this.hangUp();
          this.connect();
        }
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
        // with the past come those that are known already
        if (this.program.some(({ time_s, text }) => time_s === message.time_s && text === message.text)) break;
        this.program = [...this.program, message].slice(-PROGRAM_MARKS);
        break;
      case "event":
        for (const listener of this.told.event) listener(message);
        break;
    }
  }

  private onClose(event: CloseEvent): void {
    if (this.closed) return;
    this.hangUp();
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

function close(socket: WebSocket | null): void {
  if (!socket) return;
  socket.onclose = socket.onmessage = socket.onerror = null;
  socket.close();
}
