import { describe, expect, it, vi } from "vitest";
import { type Direction, Jog } from "./Jog";

function bench() {
  const log: string[] = [];
  let answer: (value?: unknown) => void = () => undefined;
  let refuse: (error: unknown) => void = () => undefined;
  const rotate = vi.fn((direction: Direction) => {
    log.push(`rotate ${direction}`);
    return new Promise((resolve, reject) => {
      answer = resolve;
      refuse = reject;
    });
  });
  const halt = vi.fn(() => {
    log.push("stop");
    return Promise.resolve();
  });
  const keep = vi.fn(() => {
    log.push("keep");
    return Promise.resolve();
  });
  const errors: unknown[] = [];
  const jog = new Jog(rotate, keep, halt, (error) => errors.push(error));
  const settle = () => new Promise((resolve) => setTimeout(resolve));
  return { jog, log, errors, settle, answer: () => answer(), refuse: (error: unknown) => refuse(error) };
}

describe("Jog", () => {
  it("moves while held and stops once when let go", async () => {
    const { jog, log, answer, settle } = bench();
    jog.press(1);
    jog.press(1);
    jog.press(-1);
    answer();
    await settle();
    jog.release();
    jog.release();
    await settle();
    expect(log).toEqual(["rotate 1", "stop"]);
  });

  it("stops again behind a start that was still on its way", async () => {
    const { jog, log, answer, settle } = bench();
    jog.press(-1);
    jog.release();
    expect(log).toEqual(["rotate -1", "stop"]);
    answer();
    await settle();
    expect(log).toEqual(["rotate -1", "stop", "stop"]);
  });

  it("says that it is held for as long as it is, and not before the start is answered", async () => {
    vi.useFakeTimers();
    try {
      const { jog, log, answer } = bench();
      jog.press(1);
      await vi.advanceTimersByTimeAsync(1000);
      expect(log).toEqual(["rotate 1"]);
      answer();
      await vi.advanceTimersByTimeAsync(600);
      expect(log).toEqual(["rotate 1", "keep", "keep", "keep"]);
      jog.release();
      await vi.advanceTimersByTimeAsync(1000);
      expect(log).toEqual(["rotate 1", "keep", "keep", "keep", "stop"]);
    } finally {
      vi.useRealTimers();
    }
  });

  it("reports a refused start and can be pressed again", async () => {
    const { jog, log, errors, refuse, settle } = bench();
    jog.press(1);
    refuse("no");
    await settle();
    jog.release();
    jog.press(-1);
    expect(errors).toEqual(["no"]);
    expect(log).toEqual(["rotate 1", "stop", "rotate -1"]);
  });

  it("leaves alone the motor that it was not let near", async () => {
    const log: string[] = [];
    const jog = new Jog(
      () => Promise.reject(new Error("only looking")),
      () => Promise.resolve(log.push("keep")),
      () => Promise.resolve(log.push("stop")),
      (error) => log.push(String(error)),
      () => undefined,
      () => true,
    );
    jog.press(1);
    await new Promise((resolve) => setTimeout(resolve));
    expect(jog.direction).toBeNull();
    jog.release();
    expect(log).toEqual(["Error: only looking"]);
  });
});
