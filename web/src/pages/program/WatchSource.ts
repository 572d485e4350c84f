import type { Schemas } from "../../api/client";

export type Seen = Schemas["ProgramSeen"];
type Message = Schemas["ProgramMessage"];
export type OpenSocket = (url: string, protocol: string) => WebSocket;

const PROTOCOL = "stepscope.program.v1";
const FIRST_RETRY_MS = 250;
const LAST_RETRY_MS = 3000;
/** The server says something every second: a socket on which nothing came for so long is dead, though it be open. */
const SILENT_AFTER_MS = 3000;
export const TRACE_MAX = 200;
const LOG_MAX = 200;

/** Something that the program did, by device time, which is that of the scope and of recordings. */
export interface Entry {
  id: number;
  timeS: number;
  text: string;
}

export interface WatchState {
  seen: Seen | null;
  /** why nothing is known now; empty while something is */
  lost: string;
  /** about how often the device is looked at [Hz] */
  rateHz: number | null;
  /** addresses, the latest last; null stands where some may be missing */
  trace: readonly number[];
  /** whether the trace has every command: it was stepped */
  exact: boolean;
  log: readonly Entry[];
  refused: string;
}

const NOTHING: WatchState = {
  seen: null,
  lost: "The server is being asked",
  rateHz: null,
  trace: [],
  exact: false,
  log: [],
  refused: "",
};

/** What a device's program does, as the server tells it. It connects again by itself. */
export class WatchSource {
  state: WatchState = NOTHING;
  private readonly listeners = new Set<() => void>();
  private socket: WebSocket | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private silence: ReturnType<typeof setTimeout> | undefined;
  private retryMs = FIRST_RETRY_MS;
  private variables: readonly number[] = [];
  private entries = 0;
  private stopped = true;

  constructor(
    private readonly device: string,
    private readonly open: OpenSocket = (url, protocol) => new WebSocket(url, protocol),
  ) {}

  start(): void {
    this.stopped = false;
    this.connect();
  }

  stop(): void {
    this.stopped = true;
    clearTimeout(this.timer);
    this.hangUp();
  }

  subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  snapshot = (): WatchState => this.state;

  watch(variables: readonly number[]): void {
    this.variables = variables;
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ variables }));
  }

  private connect(): void {
    const url = new URL(`/api/v1/devices/${encodeURIComponent(this.device)}/program/watch`, window.location.origin);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    const socket = this.open(url.href, PROTOCOL);
    this.socket = socket;
    this.listenFor();
    socket.onopen = () => {
      if (this.variables.length > 0) socket.send(JSON.stringify({ variables: this.variables }));
    };
    socket.onmessage = ({ data }: MessageEvent<string>) => this.hear(JSON.parse(data));
    socket.onclose = () => this.again("The server does not answer: nobody knows what the program does");
  }

  private again(why: string): void {
    this.hangUp();
    this.change({ lost: this.state.refused || why });
    if (this.stopped) return;
    const wait = this.retryMs * (0.8 + 0.4 * Math.random()); // so that many pages do not come back in step
    this.retryMs = Math.min(LAST_RETRY_MS, 2 * this.retryMs);
    this.timer = setTimeout(() => this.connect(), wait);
  }

  private listenFor(): void {
    clearTimeout(this.silence);
    this.silence = setTimeout(() => this.again("The server has fallen silent"), SILENT_AFTER_MS);
  }

  private hangUp(): void {
    clearTimeout(this.silence);
    const { socket } = this;
    this.socket = null;
    if (!socket) return;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
  }

  private hear(message: Message): void {
    this.listenFor();
    if (message.type === "start") {
      this.retryMs = FIRST_RETRY_MS;
      this.change({ rateHz: message.rate_hz, refused: "" });
    } else if (message.type === "lost") this.change({ lost: message.problem.detail });
    else if (message.type === "refused") this.change({ refused: message.problem.detail });
    else if (message.type === "state") this.saw(message);
  }

  private saw(seen: Seen): void {
    const before = this.state.seen;
    const stepped = seen.trace.length > 0;
    const follows = this.state.trace.at(-1) !== seen.counter && seen.status === "running";
    const added = stepped ? seen.trace : follows ? [seen.counter] : [];
    // a trace of single steps and one of looks are not of one kind: the new one begins anew
    const kept = stepped === this.state.exact || added.length === 0 ? this.state.trace : [];
    const said = before ? news(before, seen) : [`${seen.status} at ${seen.counter}`];
    this.change({
      seen,
      lost: "",
      trace: added.length > 0 ? [...kept, ...added].slice(-TRACE_MAX) : kept,
      exact: added.length > 0 ? stepped : this.state.exact,
      log:
        said.length > 0
          ? [...this.state.log, ...said.map((text) => this.entry(seen, text))].slice(-LOG_MAX)
          : this.state.log,
    });
  }

  private entry(seen: Seen, text: string): Entry {
    this.entries += 1;
    return { id: this.entries, timeS: seen.time_s, text };
  }

  private change(some: Partial<WatchState>): void {
    this.state = { ...this.state, ...some };
    for (const listener of this.listeners) listener();
  }
}

/** What is worth a line of the log between two looks. */
export function news(before: Seen, seen: Seen): string[] {
  const said: string[] = [];
  const stepping = seen.debug.state === "running";
  if (stepping && before.debug.state !== "running") said.push(`single steps from ${before.counter}`);
  if (!stepping && before.debug.state === "running") said.push(seen.debug.message);
  else if (seen.status !== before.status && !stepping) said.push(`${seen.status} at ${seen.counter}`);
  if (seen.error !== before.error && seen.error) said.push(`a command was refused: status ${seen.error}`);
  if (seen.interrupted && !before.interrupted) said.push(`an interrupt is served, at ${seen.counter}`);
  for (const [number, value] of Object.entries(seen.variables)) {
    const old = before.variables[number];
    if (old !== undefined && old !== value) said.push(`variable ${number}: ${old} → ${value}`);
  }
  return said;
}
