import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { durationOf, HeldRun, type RunState, sweep, withRamps } from "./HeldRun";
import { endText } from "./runText";

describe("HeldRun", () => {
  let sent: string[];
  let states: RunState["phase"][];
  let answers: { resolve: () => void; reject: (error: unknown) => void }[];
  let keepFails: boolean;
  let run: HeldRun;

  const settle = () => vi.advanceTimersByTimeAsync(0);

  beforeEach(() => {
    vi.useFakeTimers();
    sent = [];
    states = [];
    answers = [];
    keepFails = false;
    run = new HeldRun(
      {
        rotate: (velocity) => {
          sent.push(`rotate ${velocity}`);
          return new Promise<void>((resolve, reject) => answers.push({ resolve, reject }));
        },
        keep: () => {
          sent.push("keep");
          return keepFails ? Promise.reject(new Error("nothing is held")) : Promise.resolve();
        },
        halt: () => {
          sent.push("halt");
          return Promise.resolve();
        },
      },
      (state) => states.push(state.phase),
    );
  });
  afterEach(() => {
    vi.useRealTimers();
  });

  it("turns through its legs, keeps each up, and stops at the end", async () => {
    run.start([
      { velocityPps: 100, forS: 1 },
      { velocityPps: -50, forS: 0.5 },
    ]);
    answers[0]?.resolve();
    await vi.advanceTimersByTimeAsync(1000);
    expect(sent).toEqual(["rotate 100", "keep", "keep", "rotate -50"]);
    answers[1]?.resolve();
    await vi.advanceTimersByTimeAsync(500);
    expect(sent.at(-1)).toBe("halt");
    expect(run.state).toEqual({ phase: "done" });
    await vi.advanceTimersByTimeAsync(5000);
    expect(sent.at(-1)).toBe("halt");
  });

  it("stops at once when aborted, and again behind a start that was not answered yet", async () => {
    run.start([{ velocityPps: 100, forS: 1 }]);
    run.abort();
    expect(sent).toEqual(["rotate 100", "halt"]);
    answers[0]?.resolve();
    await settle();
    expect(sent).toEqual(["rotate 100", "halt", "halt"]);
    await vi.advanceTimersByTimeAsync(5000);
    expect(sent).toHaveLength(3);
    expect(states).toEqual(["running", "stopped"]);
  });

  it("ends without a word when something else has stopped the motor", async () => {
    run.start([{ velocityPps: 100, forS: 10 }]);
    answers[0]?.resolve();
    await settle();
    keepFails = true;
    await vi.advanceTimersByTimeAsync(5000);
    expect(sent).toEqual(["rotate 100", "keep"]);
    expect(run.state.phase).toBe("ended");
    run.start([{ velocityPps: 7, forS: 1 }]);
    expect(sent.at(-1)).toBe("rotate 7");
  });

  it("says for how long the server heard nothing of it, where that is why it ended", async () => {
    run.start([{ velocityPps: 100, forS: 100 }]);
    answers[0]?.resolve();
    await vi.advanceTimersByTimeAsync(800);
    expect(sent).toEqual(["rotate 100", "keep", "keep"]);
    vi.setSystemTime(Date.now() + 60_000 - 400); // a browser wakes a tab that nobody looks at once a minute
    keepFails = true;
    await vi.advanceTimersByTimeAsync(400);
    expect(run.state).toMatchObject({ phase: "ended", unheardS: 60 });
    expect(endText(run.state)).toContain("nothing of this tab for 60.0\u202fs");
    expect(sent.at(-1)).toBe("keep"); // nothing is sent behind it
  });

  it("tells what else ended it, and nothing of what was wanted", async () => {
    run.start([{ velocityPps: 100, forS: 10 }]);
    answers[0]?.resolve();
    keepFails = true;
    await vi.advanceTimersByTimeAsync(400);
    expect(run.state).not.toHaveProperty("unheardS");
    expect(endText(run.state)).toBe("Turning failed: nothing is held");
    expect(endText({ phase: "stuck", reason: "right_switch" })).toBe("Ended: right switch.");
    for (const phase of ["done", "stopped"] as const) expect(endText({ phase })).toBeNull();
  });

  it("does not go on against a switch", async () => {
    run.start([
      { velocityPps: 100, forS: 1 },
      { velocityPps: 200, forS: 1 },
    ]);
    answers[0]?.resolve();
    await settle();
    run.stuck("right_switch");
    expect(run.state).toEqual({ phase: "stuck", reason: "right_switch" });
    await vi.advanceTimersByTimeAsync(5000);
    expect(sent).toEqual(["rotate 100", "halt"]);
    run.stuck("left_switch"); // nothing runs
    expect(sent).toHaveLength(2);
  });

  it("says why it could not begin, and begins nothing while it runs", async () => {
    run.start([{ velocityPps: 100, forS: 1 }]);
    run.start([{ velocityPps: 999, forS: 1 }]);
    expect(sent).toEqual(["rotate 100"]);
    answers[0]?.reject(new Error("disconnected"));
    await settle();
    expect(run.state).toMatchObject({ phase: "ended" });
    run.start([]);
    expect(sent).toEqual(["rotate 100"]);
  });
});

describe("a sweep", () => {
  it("goes up and comes back, the fastest once", () => {
    expect(sweep(10, 30, 3, 2).map((leg) => leg.velocityPps)).toEqual([10, 20, 30, 20, 10]);
    expect(sweep(10, 20, 2, 1, true).map((leg) => leg.velocityPps)).toEqual([10, -10, 20, -20, 10, -10]);
    const legs = withRamps(sweep(10, 20, 2, 1, true), 10);
    expect(legs.map((leg) => leg.forS)).toEqual([2, 3, 4, 5, 4, 3]);
    expect(durationOf(legs)).toBe(21);
    expect(withRamps(legs, null)).toEqual(legs);
    expect(sweep(10, 30, 1, 2)).toEqual([{ velocityPps: 30, forS: 2 }]);
  });
});
