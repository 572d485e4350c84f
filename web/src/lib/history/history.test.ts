import { beforeEach, describe, expect, it } from "vitest";
import { forget, forgetAll, goTo, record, redo, settle, stepsNow, undo } from "./history";

let value = 0;

function to(next: number, merge: string | null = null, now = 0, of = "design") {
  const before = value;
  value = next;
  const set = (to: number) => () => {
    value = to;
  };
  record({ label: `to ${next}`, of, merge, undo: set(before), redo: set(next) }, now);
}

beforeEach(() => {
  window.dispatchEvent(new Event("pointerup"));
  forgetAll();
  value = 0;
});

describe("history", () => {
  it("goes back and forth, and a new change ends what could be redone", () => {
    to(1);
    to(2);
    expect([undo(), undo(), undo()]).toEqual(["to 2", "to 1", null]);
    expect(value).toBe(0);
    expect(redo()).toBe("to 1");
    to(5);
    expect(redo()).toBeNull();
    undo();
    expect(value).toBe(1);
  });

  it("keeps 200 at most", () => {
    for (let next = 1; next <= 250; next++) to(next);
    expect(stepsNow().past).toHaveLength(200);
    goTo(0);
    expect(value).toBe(50);
  });

  it("makes one entry of changes with one key that follow quickly, and another after a rest", () => {
    to(1, "vmax", 0);
    to(2, "vmax", 300);
    to(3, "vmax", 600);
    expect(stepsNow().past.map(({ label }) => label)).toEqual(["to 3"]);
    to(4, "vmax", 5000);
    to(5, "amax", 5001);
    settle();
    to(6, "amax", 5002);
    expect(stepsNow().past).toHaveLength(4);
    goTo(stepsNow().past[0]?.id ?? 0);
    expect(value).toBe(3);
    undo();
    expect(value).toBe(0);
    redo();
    expect(value).toBe(3);
  });

  it("makes one entry of a drag however long it takes, and the next drag is another", () => {
    for (const from of [0, 10]) {
      window.dispatchEvent(new Event("pointerdown"));
      to(from + 1, "vmax", from * 1000);
      to(from + 2, "vmax", from * 1000 + 4000);
      window.dispatchEvent(new Event("pointerup"));
    }
    expect(stepsNow().past.map(({ label }) => label)).toEqual(["to 2", "to 12"]);
  });

  it("goes to an entry that was taken back", () => {
    to(1);
    to(2);
    to(3);
    const third = stepsNow().past[2]?.id ?? 0;
    goTo(0);
    goTo(third);
    expect(value).toBe(3);
  });

  it("asks about a write instead of taking it back, and drops what belongs to it", () => {
    to(1, null, 0, "staged");
    to(2);
    let asked = 0;
    forget("staged");
    record({ label: "written", of: "device", asks: true, undo: () => asked++, redo: () => asked-- });
    expect(undo()).toBe("written");
    expect([asked, value, stepsNow().future.length]).toEqual([1, 2, 0]);
    expect(undo()).toBe("to 2");
    expect(undo()).toBeNull();
  });
});
