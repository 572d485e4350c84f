import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Schemas } from "../api/client";
import { telemetryUrl } from "./request";
import { TelemetrySource } from "./TelemetrySource";

/** The server's side of a socket, in the test's hands. */
class FakeSocket {
  binaryType = "";
  onmessage: ((event: { data: ArrayBuffer | string }) => void) | null = null;
  onclose: ((event: { code: number; reason: string }) => void) | null = null;
  onerror: (() => void) | null = null;
  closedByPage = false;
  close() {
    this.closedByPage = true;
  }
}

type Message = Schemas["TelemetryMessage"];

const REQUEST = { device: "tmc428 demo", channels: ["position.0"], rateHz: 100, keepS: 1 };
const START: Message = {
  type: "start",
  device: "tmc428",
  channels: [{ name: "position.0", unit: "microsteps" }],
  rate_hz: 50,
  requested_rate_hz: 100,
  chip_timed: true,
  time_origin_unix_s: 1000,
  history_rows: 0,
};

function frame(times: number[], values: number[], dropped = 0): ArrayBuffer {
  const message = new ArrayBuffer(24 + 16 * times.length);
  new Uint8Array(message).set([83, 83, 67, 49]);
  const view = new DataView(message);
  view.setUint32(8, times.length, true);
  view.setUint32(12, 1, true);
  view.setBigUint64(16, BigInt(dropped), true);
  new Float64Array(message, 24).set([...times, ...values]);
  return message;
}

const STATUS: Schemas["TelemetryStatus"] = {
  type: "status",
  achieved_rate_hz: 49.8,
  jitter_ms: 0.2,
  dropped: 0,
  latency_ms: 3,
  calls_per_s: 512,
  calls_per_s_possible: null,
  row_spread_ms: 0,
};

describe("TelemetrySource", () => {
  let sockets: FakeSocket[];
  let source: TelemetrySource;
  const tell = (data: ArrayBuffer | Message) =>
    sockets.at(-1)?.onmessage?.({ data: data instanceof ArrayBuffer ? data : JSON.stringify(data) });

  beforeEach(() => {
    vi.useFakeTimers();
    sockets = [];
    source = new TelemetrySource(REQUEST, () => {
      const socket = new FakeSocket();
      sockets.push(socket);
      return socket as unknown as WebSocket;
    });
    source.start();
  });
  afterEach(() => {
    source.stop();
    vi.useRealTimers();
  });

  it("asks for its channels, rate and history", () => {
    expect(telemetryUrl(REQUEST, "https://bench:8000")).toBe(
      "wss://bench:8000/api/v1/devices/tmc428%20demo/telemetry?channels=position.0&rate_hz=100&history_s=1",
    );
  });

  it("takes the granted rate, the samples and the status", () => {
    tell(START);
    tell(frame([1, 2], [10, 20]));
    tell(STATUS);
    expect(source.link()).toMatchObject({ phase: "live", rateHz: 50, achievedRateHz: 49.8, timeOriginUnixS: 1000 });
    expect([...(source.buffer.column("position.0") ?? [])]).toEqual([10, 20]);
  });

  it("leaves a gap where rows were dropped or the device vanished", () => {
    tell(START);
    tell(frame([1], [10]));
    tell(frame([3], [30], 5));
    tell({ type: "gap", reason: "tmc428: unplugged" });
    expect(source.link()).toMatchObject({ phase: "gap", dropped: 5, reason: "tmc428: unplugged" });
    tell(frame([4], [40], 5));
    expect(source.link().phase).toBe("live");
    expect([...(source.buffer.column("position.0") ?? [])]).toEqual([10, Number.NaN, 30, Number.NaN, 40]);
  });

  it("comes back by itself, each time a little later, and not after stop", () => {
    tell(START);
    tell(frame([1], [10]));
    for (const [attempt, mostMs] of [400, 700, 1300, 2500].entries()) {
      sockets.at(-1)?.onclose?.({ code: 1006, reason: "" });
      expect(source.link().phase).toBe("lost");
      vi.advanceTimersByTime(mostMs);
      expect(sockets).toHaveLength(attempt + 2);
    }
    tell(START);
    expect(source.link().phase).toBe("live");
    expect(source.buffer.length).toBe(0);
    sockets.at(-1)?.onclose?.({ code: 1006, reason: "" });
    source.stop();
    vi.advanceTimersByTime(60_000);
    expect(sockets).toHaveLength(5);
  });

  it("shows the history of a new socket when the whole of it has come", () => {
    tell(START);
    tell(frame([1, 2], [10, 20]));
    sockets.at(-1)?.onclose?.({ code: 1006, reason: "" });
    vi.advanceTimersByTime(400);
    tell({ ...START, history_rows: 3 });
    tell(frame([0.5, 1], [5, 10]));
    expect([...(source.buffer.column("position.0") ?? [])]).toEqual([10, 20, Number.NaN]);
    tell(frame([2], [20]));
    expect([...(source.buffer.column("position.0") ?? [])]).toEqual([5, 10, 20]);
    tell(frame([3], [30]));
    expect([...(source.buffer.column("position.0") ?? [])]).toEqual([5, 10, 20, 30]);
  });

  it("says why the server refused", () => {
    sockets.at(-1)?.onclose?.({ code: 4404, reason: "no channel position.7" });
    expect(source.link()).toMatchObject({ phase: "refused", reason: "no channel position.7" });
  });

  it("tells why a motor stopped, and what the wire carries", () => {
    const stops: Message[] = [];
    source.on("stopped", (stop) => stops.push(stop));
    tell(START);
    const stop: Message = {
      type: "stopped",
      axis: 0,
      reason: "stall",
      time_s: 3.5,
      position: -120,
      detail: "load value 0",
    };
    tell(stop);
    expect(stops).toEqual([stop]);
    tell(STATUS);
    expect(source.link()).toMatchObject({ callsPerS: 512, callsPerSPossible: null, rowSpreadMs: 0 });
  });

  it("tells what a chip's event register told", () => {
    const events: Message[] = [];
    const end = source.on("event", (event) => events.push(event));
    tell(START);
    const event: Message = { type: "event", axis: 0, seq: 7, time_s: 4.25, names: ["STOPL_EVENT", "VEL_STATE_00"] };
    tell(event);
    end();
    tell({ type: "event", axis: 0, seq: 8, time_s: 5, names: ["RST_EV"] });
    expect(events).toEqual([event]);
  });

  it("tells of moves", () => {
    const moves: Message[] = [];
    source.on("move", (move) => moves.push(move));
    tell(START);
    tell({ type: "move", axis: 2, started_at_s: 12.5 });
    expect(moves).toEqual([{ type: "move", axis: 2, started_at_s: 12.5 }]);
  });
});
