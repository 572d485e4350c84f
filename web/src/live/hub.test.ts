import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { joined, TelemetryHub } from "./hub";
import type { TelemetryRequest } from "./request";
import { TelemetrySource } from "./TelemetrySource";

/** The server's side of a socket, in the test's hands. */
class FakeSocket {
  binaryType = "";
  onmessage: ((event: { data: ArrayBuffer | string }) => void) | null = null;
  onclose: ((event: { code: number; reason: string }) => void) | null = null;
  onerror: (() => void) | null = null;
  closed = false;
  readonly channels: string[];
  constructor(readonly url: URL) {
    this.channels = url.searchParams.get("channels")?.split(",") ?? [];
  }
  close() {
    this.closed = true;
  }
  tell(message: object) {
    this.onmessage?.({ data: JSON.stringify(message) });
  }
  start(historyRows = 0) {
    const channels = this.channels.map((name) => ({ name, unit: "microsteps" }));
    const rate = Number(this.url.searchParams.get("rate_hz"));
    this.tell({
      type: "start",
      device: "d",
      channels,
      rate_hz: rate,
      requested_rate_hz: rate,
      chip_timed: true,
      time_origin_unix_s: 1000,
      history_rows: historyRows,
    });
  }
  /** rows at these times; the value of a channel is its axis number and the time */
  rows(...times: number[]) {
    const count = this.channels.length;
    const message = new ArrayBuffer(24 + 8 * times.length * (count + 1));
    new Uint8Array(message).set([83, 83, 67, 49]);
    const view = new DataView(message);
    view.setUint32(8, times.length, true);
    view.setUint32(12, count, true);
    const values = this.channels.flatMap((name) => times.map((time) => 100 * Number(name.at(-1)) + time));
    new Float64Array(message, 24).set([...times, ...values]);
    this.onmessage?.({ data: message });
  }
}

const wish = (channels: string[], rateHz = 10, keepS = 60): TelemetryRequest => ({
  device: "d",
  channels,
  rateHz,
  keepS,
});
const settled = () => vi.advanceTimersByTimeAsync(0);

describe("TelemetryHub", () => {
  let sockets: FakeSocket[];
  let hub: TelemetryHub;
  const open = () => sockets.filter(({ closed }) => !closed);
  const source = () => hub.sourceOf("d");
  const seen = (channel: string) => [...(source().buffer.column(channel) ?? [])];

  beforeEach(() => {
    vi.useFakeTimers();
    sockets = [];
    hub = new TelemetryHub(
      (request) =>
        new TelemetrySource(request, (url) => {
          const socket = new FakeSocket(new URL(url));
          sockets.push(socket);
          return socket as unknown as WebSocket;
        }),
    );
  });
  afterEach(() => {
    source().stop();
    vi.useRealTimers();
  });

  it("asks once for all that is wanted: the union at the highest rate, kept for the longest", async () => {
    hub.want(wish(["p.0", "p.1"], 30, 4));
    hub.want(wish(["v.0", "p.0"], 500, 60));
    await settled();
    expect(sockets).toHaveLength(1);
    expect(Object.fromEntries(sockets[0]?.url.searchParams ?? [])).toEqual({
      channels: "p.0,p.1,v.0",
      rate_hz: "500",
      history_s: "60",
    });
  });

  it("says the same request whatever the order of the wishes", () => {
    const one = joined("d", [wish(["b.0", "a.0"]), wish(["c.0"], 20)]);
    expect(joined("d", [wish(["c.0"], 20), wish(["a.0", "b.0"])])).toEqual(one);
  });

  it("adds a channel without a hole and without a row twice", async () => {
    hub.want(wish(["p.0"]));
    await settled();
    const [old] = sockets as [FakeSocket];
    old.start();
    old.rows(1, 2, 3);
    hub.want(wish(["p.1"]));
    await settled();
    const next = sockets[1] as FakeSocket;
    expect(next.channels).toEqual(["p.0", "p.1"]);
    next.start(2);
    next.rows(2, 3); // the past of both
    old.rows(4);
    next.rows(5, 6);
    expect(old.closed).toBe(false); // it has not come as far as the new one begins
    expect(seen("p.0")).toEqual([1, 2, 3, 4]);
    old.rows(5);
    expect(open()).toEqual([next]);
    next.rows(7);
    expect([...source().buffer.times()]).toEqual([1, 2, 3, 4, 5, 6, 7]);
    expect(seen("p.0")).toEqual([1, 2, 3, 4, 5, 6, 7]);
    // of before it has what the server remembers, at the rows that were kept
    expect(seen("p.1")).toEqual([102, 102, 103, 103, 105, 106, 107]);
    expect(source().link()).toMatchObject({ phase: "live", rateHz: 10 });
  });

  it("keeps what is older in the server's history than in the page", async () => {
    const slow = hub.want(wish(["p.0"], 10, 1));
    await settled();
    sockets[0]?.start();
    sockets[0]?.rows(8, 9);
    hub.want(wish(["p.0"], 100, 60));
    slow();
    await settled();
    sockets[1]?.start(4);
    sockets[1]?.rows(6, 7, 8, 9);
    sockets[1]?.rows(9.5);
    sockets[0]?.rows(9.5);
    expect([...source().buffer.times()]).toEqual([6, 7, 8, 9, 9.5]);
  });

  it("tells once what both sockets of a change tell", async () => {
    const moves: number[] = [];
    hub.want(wish(["p.0"]));
    source().on("move", (move) => moves.push(move.started_at_s));
    await settled();
    const [old] = sockets as [FakeSocket];
    old.start();
    old.rows(1);
    hub.want(wish(["p.1"]));
    await settled();
    const next = sockets[1] as FakeSocket;
    const move = (at: number) => ({ type: "move", axis: 0, started_at_s: at });
    next.start();
    next.tell(move(1.5)); // the old socket will not have told it
    old.tell(move(1.2));
    next.tell(move(1.2));
    old.tell(move(1.7));
    next.rows(2);
    old.rows(2);
    next.tell(move(1.7)); // late
    next.tell(move(3));
    expect(moves).toEqual([1.2, 1.7, 1.5, 3]);
  });

  it("does not wait for ever for the old socket", async () => {
    hub.want(wish(["p.0"]));
    await settled();
    sockets[0]?.start();
    sockets[0]?.rows(1);
    hub.want(wish(["p.1"]));
    await settled();
    sockets[1]?.start();
    sockets[1]?.rows(2);
    await vi.advanceTimersByTimeAsync(1100);
    sockets[1]?.rows(3);
    expect(open()).toEqual([sockets[1]]);
    expect([...source().buffer.times()]).toEqual([1, 2, 3]);
  });

  it("lets go of a channel two seconds after the last reader of it, and of the device as well", async () => {
    const first = hub.want(wish(["p.0"]));
    const second = hub.want(wish(["p.1"]));
    await settled();
    sockets[0]?.start();
    sockets[0]?.rows(1);
    second();
    await vi.advanceTimersByTimeAsync(1900);
    expect(sockets).toHaveLength(1);
    await vi.advanceTimersByTimeAsync(200);
    expect(sockets[1]?.channels).toEqual(["p.0"]);
    sockets[1]?.start();
    sockets[1]?.rows(2);
    sockets[0]?.rows(2);
    first();
    await vi.advanceTimersByTimeAsync(1900);
    expect(open()).toHaveLength(1);
    await vi.advanceTimersByTimeAsync(200);
    expect(open()).toHaveLength(0);
    expect(source().link().phase).toBe("connecting");
  });

  it("goes on with the socket of before where the next page wants the same in time", async () => {
    hub.want(wish(["p.0"]))();
    await vi.advanceTimersByTimeAsync(1000);
    const one = hub.want(wish(["p.0"]));
    await settled();
    one();
    await vi.advanceTimersByTimeAsync(1000);
    hub.want(wish(["p.0"]));
    await vi.advanceTimersByTimeAsync(5000);
    expect(sockets).toHaveLength(1);
    expect(open()).toHaveLength(1);
  });

  it("begins anew where nothing comes that could go on", async () => {
    hub.want(wish(["p.0"]));
    await settled();
    hub.want(wish(["p.1"]));
    await settled();
    expect(sockets).toHaveLength(2);
    expect(open()).toEqual([sockets[1]]);
    sockets[1]?.start();
    sockets[1]?.rows(1);
    expect(seen("p.1")).toEqual([101]);
  });

  it("says why the server refuses what is wanted now", async () => {
    hub.want(wish(["p.0"]));
    await settled();
    sockets[0]?.start();
    sockets[0]?.rows(1);
    hub.want(wish(["p.9"]));
    await settled();
    sockets[1]?.onclose?.({ code: 4404, reason: "no channel p.9" });
    expect(source().link()).toMatchObject({ phase: "refused", reason: "no channel p.9" });
    expect(sockets[0]?.closed).toBe(true);
  });
});
