import type { Schemas } from "../api/client";
import { sessionId } from "../api/lease/session";

export type Condition = Schemas["Condition"];
export type Kind = Condition["kind"];
/** How an axis stands: its condition, whether it is referenced, and of an emulator what is really so. */
export type Standing = Pick<Schemas["AxisInfo"], "condition" | "referenced" | "ground_truth">;
export type AxisStanding = Schemas["AxisCondition"];
type Message = Schemas["ConditionsMessage"];

/** How a socket is made; tests bring their own. */
export type OpenSocket = (url: string, protocol: string) => WebSocket;

const PROTOCOL = "stepscope.conditions.v1";
const FIRST_RETRY_MS = 250;
const LAST_RETRY_MS = 3000;
/** The server says something every second: a socket on which nothing came for so long is dead, though it be open. */
const SILENT_AFTER_MS = 3000;
const LOOK_EVERY_MS = 250;
/** An axis that has just come to rest may only be waiting between two moves. */
const SETTLED_AFTER_MS = 2000;

function unknown(cause: string): Standing {
  const condition: Condition = { kind: "unknown", cause, evidence: [], remedies: [], remedy: null, since_s: null };
  return { condition, referenced: null, ground_truth: null };
}

const NOT_YET = unknown("the server is being asked");
const SILENT = unknown("the server does not answer: nobody knows what the axis does");
const UNTOLD = unknown("the server has not told of this axis");

interface Entry {
  standing: AxisStanding;
  /** it was seen moving, or nobody knew, when it was last seen */
  restless: boolean;
  restlessAtMs: number;
}

/**
 * The condition of every axis, as the server tells it: the page's only source. It connects again by itself, and while
 * the server is away every axis is unknown, whatever it was before.
 */
export class ConditionSource {
  private readonly entries = new Map<string, Entry>();
  private readonly listeners = new Set<() => void>();
  private socket: WebSocket | null = null;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private watch: ReturnType<typeof setInterval> | undefined;
  private retryMs = FIRST_RETRY_MS;
  private heardAtMs = Number.NEGATIVE_INFINITY;
  private commandedAtMs = Number.NEGATIVE_INFINITY;
  private told = false;
  private ever = false;
  private lookedAtMs = 0;
  private version = 0;

  constructor(
    private readonly open: OpenSocket = (url, protocol) => new WebSocket(url, protocol),
    private readonly nowMs: () => number = () => performance.now(),
  ) {}

  /** Connect, and stay so until `stop`. A second start does nothing. */
  start(): void {
    if (this.watch !== undefined) return;
    this.watch = setInterval(() => this.look(), LOOK_EVERY_MS);
    this.connect();
  }

  stop(): void {
    clearInterval(this.watch);
    clearTimeout(this.timer);
    this.watch = undefined;
    this.hangUp();
    this.told = false;
  }

  subscribe = (listener: () => void): (() => void) => {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  };

  /** Another number after every change, for `useSyncExternalStore`. */
  revision = (): number => this.version;

  /** This page has sent something that may set a motor in motion: what it does is not known before the next look. */
  commanded(): void {
    this.commandedAtMs = this.nowMs();
  }

  /** Whether what is told here is so now: the socket is up, and the server is not silent. */
  get live(): boolean {
    return this.told && this.nowMs() - this.heardAtMs < SILENT_AFTER_MS;
  }

  /** How an axis stands; always the same object until that changes. */
  of(device: string, axis: number): Standing {
    if (!this.live) return this.ever ? SILENT : NOT_YET;
    return this.entries.get(`${device}/${axis}`)?.standing ?? UNTOLD;
  }

  all(): readonly AxisStanding[] {
    return this.live ? [...this.entries.values()].map(({ standing }) => standing) : [];
  }

  /** Whether any axis moves, or may: what nobody knows may move, and what has just stopped may go on. */
  mayMove(): boolean {
    const now = this.nowMs();
    if (!this.live || now - this.commandedAtMs < SETTLED_AFTER_MS) return true;
    return [...this.entries.values()].some(
      ({ restless, restlessAtMs }) => restless || now - restlessAtMs < SETTLED_AFTER_MS,
    );
  }

  // --- inside ---------------------------------------------------------------------------------

  private connect(): void {
    const url = new URL("/api/v1/conditions", window.location.origin);
    url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
    const socket = this.open(url.href, PROTOCOL);
    this.socket = socket;
    this.heardAtMs = this.nowMs();
    // when this page ends, and cannot say so, the socket does
    socket.onopen = () => socket.send(JSON.stringify({ session: sessionId } satisfies Schemas["ConditionsPage"]));
    socket.onmessage = ({ data }: MessageEvent<string>) => this.hear(JSON.parse(data));
    socket.onclose = () => {
      this.socket = null;
      this.connectLater();
    };
  }

  private connectLater(): void {
    this.told = false;
    this.changed();
    const wait = this.retryMs * (0.8 + 0.4 * Math.random()); // so that many pages do not come back in step
    this.retryMs = Math.min(LAST_RETRY_MS, 2 * this.retryMs);
    this.timer = setTimeout(() => this.connect(), wait);
  }

  /** A socket that has fallen silent is given up: nothing says that it will ever close. */
  private look(): void {
    const now = this.nowMs();
    const held = now - this.lookedAtMs > 4 * LOOK_EVERY_MS; // this page itself was: what came meanwhile waits to be heard
    this.lookedAtMs = now;
    if (held || this.socket === null || now - this.heardAtMs < SILENT_AFTER_MS) return;
    this.hangUp();
    this.connectLater();
  }

  private hangUp(): void {
    const { socket } = this;
    this.socket = null;
    if (!socket) return;
    socket.onopen = socket.onclose = socket.onmessage = null;
    socket.close();
  }

  private hear(message: Message): void {
    this.heardAtMs = this.nowMs();
    if (message.type === "snapshot") {
      const before = new Map(this.entries);
      this.entries.clear();
      for (const standing of message.axes) this.put(standing, before.get(`${standing.device}/${standing.axis}`));
      this.told = this.ever = true;
      this.retryMs = FIRST_RETRY_MS;
    } else if (message.type === "condition") {
      this.put(message, this.entries.get(`${message.device}/${message.axis}`));
    } else if (message.type === "alive") {
      return;
    } else if (message.type === "removed") {
      for (const [key, { standing }] of this.entries) if (standing.device === message.device) this.entries.delete(key);
    }
    this.changed();
  }

  private put(standing: AxisStanding, before: Entry | undefined): void {
    const { kind } = standing.condition;
    // a device that went away while it moved may move on, and nobody would see it
    const restless = kind === "not_connected" ? (before?.restless ?? false) : kind === "moving" || kind === "unknown";
    const restlessAtMs =
      restless || before?.restless ? this.nowMs() : (before?.restlessAtMs ?? Number.NEGATIVE_INFINITY);
    this.entries.set(`${standing.device}/${standing.axis}`, { standing, restless, restlessAtMs });
  }

  private changed(): void {
    this.version += 1;
    for (const listener of this.listeners) listener();
  }
}

/** Of this page. */
export const conditions = new ConditionSource();
