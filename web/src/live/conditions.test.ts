import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import type { Schemas } from "../api/client";
import { type AxisStanding, ConditionSource, type Kind } from "./conditions";

/** The server's side of a socket, in the test's hands. */
class FakeSocket {
  onmessage: ((event: { data: string }) => void) | null = null;
  onclose: (() => void) | null = null;
  close() {}
}

function standing(kind: Kind, device = "bench", axis = 0): AxisStanding {
  const condition = { kind, cause: "", evidence: [], remedies: [], remedy: null, since_s: 1 };
  return { type: "condition", device, axis, condition, referenced: null, ground_truth: null };
}

describe("ConditionSource", () => {
  let sockets: FakeSocket[];
  let source: ConditionSource;
  const tell = (message: Schemas["ConditionsMessage"]) =>
    sockets.at(-1)?.onmessage?.({ data: JSON.stringify(message) });
  const snapshot = (...axes: AxisStanding[]) => tell({ type: "snapshot", axes });
  const kind = () => source.of("bench", 0).condition.kind;
  /** Time passes, and the server says now and then that it is there. */
  const live = (ms: number) => {
    for (let left = ms; left > 0; left -= 500) {
      vi.advanceTimersByTime(Math.min(500, left));
      tell({ type: "alive" });
    }
  };

  beforeEach(() => {
    vi.useFakeTimers();
    sockets = [];
    source = new ConditionSource(() => {
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

  it("knows nothing before it is told, and then each change", () => {
    expect(kind()).toBe("unknown");
    snapshot(standing("on_target"));
    expect(kind()).toBe("on_target");
    tell(standing("stalled"));
    expect(kind()).toBe("stalled");
    tell({ type: "removed", device: "bench" });
    expect(kind()).toBe("unknown");
  });

  it("calls nothing on target while the server is away, and is told anew when it is back", () => {
    snapshot(standing("on_target"));
    sockets.at(-1)?.onclose?.();
    expect(kind()).toBe("unknown");
    vi.advanceTimersByTime(400);
    expect(sockets).toHaveLength(2);
    expect(kind()).toBe("unknown");
    snapshot(standing("held"));
    expect(kind()).toBe("held");
  });

  it("tries again at a bounded rate", () => {
    for (let i = 0; i < 60; i++) {
      const socket = sockets.at(-1);
      socket?.onclose?.();
      if (socket) socket.onclose = null;
      vi.advanceTimersByTime(500);
    }
    expect(sockets.length).toBeLessThan(20);
    expect(sockets.length).toBeGreaterThan(5);
  });

  it("takes a server that is silent on an open socket for one that is away", () => {
    const changes = vi.fn();
    snapshot(standing("on_target"));
    source.subscribe(changes);
    live(10_000);
    expect(kind()).toBe("on_target");
    expect(changes).not.toHaveBeenCalled();
    vi.advanceTimersByTime(3500);
    expect(kind()).toBe("unknown");
    expect(changes).toHaveBeenCalled();
    expect(sockets).toHaveLength(2);
    snapshot(standing("on_target"));
    expect(kind()).toBe("on_target");
  });

  it("says that something may move unless every axis is known to stand", () => {
    expect(source.mayMove()).toBe(true);
    snapshot(standing("on_target"), standing("moving", "slider"));
    expect(source.mayMove()).toBe(true);
    tell(standing("ready", "slider"));
    expect(source.mayMove()).toBe(true); // it may only wait between two moves
    live(2500);
    expect(source.mayMove()).toBe(false);
    source.commanded();
    expect(source.mayMove()).toBe(true);
    live(2500);
    tell(standing("unknown", "slider"));
    expect(source.mayMove()).toBe(true);
  });

  it("takes a device that went away while it moved for one that moves on", () => {
    snapshot(standing("moving"), standing("ready", "slider"), standing("not_connected", "other"));
    live(2500);
    tell(standing("not_connected"));
    live(2500);
    expect(source.mayMove()).toBe(true);
    tell(standing("ready"));
    tell(standing("not_connected", "slider"));
    live(2500);
    expect(source.mayMove()).toBe(false);
  });
});
