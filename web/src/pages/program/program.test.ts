import { describe, expect, it } from "vitest";
import { commandOf, KEYS } from "./commands";
import { readDraft } from "./draft";
import { addressAt, addressesOf, fromBase64, placeName, toBase64 } from "./lines";
import { news, type OpenSocket, type Seen, TRACE_MAX, WatchSource } from "./WatchSource";

const SEEN: Seen = {
  type: "state",
  time_s: 1,
  status: "stopped",
  downloading: false,
  counter: 0,
  accumulator: 0,
  x: 0,
  error: 0,
  variables: {},
  flags: [],
  stack: [],
  waits: false,
  interrupted: false,
  debug: { state: "idle", mode: "run", breakpoints: [], halted_at: null, steps: 0, steps_per_s: null, message: "" },
  trace: [],
};

describe("lines and addresses", () => {
  // two constants, a label, commands in lines 4, 6 and 7; one of an included file between
  const lines = [4, 0, 6, 7];
  it("puts a breakpoint at the next command", () => {
    expect([1, 4, 5, 7, 8].map((line) => addressAt(lines, line))).toEqual([0, 0, 2, 3, null]);
    expect(addressesOf(lines, [5, 6, 8, 1])).toEqual([0, 2]);
  });
  it("names addresses by the label before them", () => {
    expect(placeName({ A: 2, B: 5 }, 1)).toBe("1");
    expect(placeName({ A: 2, B: 5 }, 5)).toBe("5 B");
    expect(placeName({ A: 2, B: 5 }, 4)).toBe("4 A+2");
  });
  it("carries bytes as base64", () => {
    const bytes = Uint8Array.from({ length: 256 }, (_, index) => index);
    expect(fromBase64(toBase64(bytes))).toEqual(bytes);
  });
});

describe("keys", () => {
  it("are those that are told, and no others", () => {
    const press = (key: string, some: object = {}) =>
      commandOf({ key, shiftKey: false, ctrlKey: false, metaKey: false, altKey: false, ...some });
    expect(press("F5")).toBe("run");
    expect(press("F5", { shiftKey: true })).toBe("stop");
    expect(press("s", { ctrlKey: true })).toBe("download");
    expect(press("s", { metaKey: true })).toBe("download");
    expect(press("Tab")).toBeNull();
    expect(press("s")).toBeNull();
    expect(press("F5", { altKey: true })).toBeNull();
    const keys = Object.values(KEYS).filter(Boolean);
    expect(new Set(keys).size).toBe(keys.length);
  });
});

it("begins anew with a draft that it cannot read", () => {
  const of = (kept: string | null) => readDraft("x", { getItem: () => kept });
  expect(of(null).text).toBe("");
  expect(of("{").text).toBe("");
  expect(of('{"text": "STOP"}')).toMatchObject({ text: "STOP", breakpoints: [], stored: null });
});

it("tells what has happened between two looks", () => {
  const debug = (state: "running" | "done", message = "") => ({ ...SEEN.debug, state, message });
  expect(news(SEEN, SEEN)).toEqual([]);
  expect(news(SEEN, { ...SEEN, status: "running", counter: 3 })).toEqual(["running at 3"]);
  expect(news(SEEN, { ...SEEN, status: "stepping", debug: debug("running") })).toEqual(["single steps from 0"]);
  expect(news({ ...SEEN, debug: debug("running") }, { ...SEEN, debug: debug("done", "halted at 6") })).toEqual([
    "halted at 6",
  ]);
  expect(news({ ...SEEN, variables: { 7: 1 } }, { ...SEEN, variables: { 7: 2 }, error: 3 })).toEqual([
    "a command was refused: status 3",
    "variable 7: 1 → 2",
  ]);
});

describe("the socket", () => {
  function source() {
    const sent: string[] = [];
    const socket = {
      readyState: WebSocket.OPEN,
      send: (text: string) => sent.push(text),
      close() {},
    } as unknown as WebSocket;
    const open: OpenSocket = () => socket;
    const made = new WatchSource("drive", open);
    made.start();
    const say = (message: object) => socket.onmessage?.({ data: JSON.stringify(message) } as MessageEvent<string>);
    return { made, sent, say, socket };
  }

  it("keeps the addresses of single steps, and says when they are only looks", () => {
    const { made, say } = source();
    say({ type: "start", device: "drive", rate_hz: 20 });
    say({ ...SEEN, status: "running", counter: 5 });
    say({ ...SEEN, status: "running", counter: 6 });
    expect([made.state.trace, made.state.exact]).toEqual([[5, 6], false]);
    say({ ...SEEN, status: "stepping", counter: 3, trace: [1, 2] });
    expect([made.state.trace, made.state.exact]).toEqual([[1, 2], true]);
    say({ ...SEEN, status: "stepping", counter: 3, trace: Array.from({ length: 300 }, (_, index) => index) });
    expect(made.state.trace.length).toBe(TRACE_MAX);
    expect(made.state.trace.at(-1)).toBe(299);
    made.stop();
  });

  it("says why nothing is known, until it is", () => {
    const { made, say, sent } = source();
    expect(made.state.lost).not.toBe("");
    say(SEEN);
    expect(made.state.lost).toBe("");
    say({ type: "lost", problem: { detail: "in download mode" } });
    expect([made.state.lost, made.state.seen?.counter]).toEqual(["in download mode", 0]);
    made.watch([7]);
    expect(sent).toEqual(['{"variables":[7]}']);
    made.stop();
  });
});
