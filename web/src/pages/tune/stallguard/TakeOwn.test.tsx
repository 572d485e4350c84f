// @vitest-environment jsdom
import { MantineProvider } from "@mantine/core";
import { act } from "react";
import { createRoot, type Root } from "react-dom/client";
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import type { Study } from "../study";
import type { StallFound } from "./rates";
import { TakeOwn } from "./TakeOwn";

declare global {
  var IS_REACT_ACT_ENVIRONMENT: boolean;
}

const OWN = { threshold: 3, filtered: false, level: -24, from_pps: 900, trial: 4 };
const FOUND = {
  speeds: [
    { speed_rps: 0.5, own: OWN },
    { speed_rps: 1, own: null },
  ],
} as unknown as StallFound;
const STUDY = { state: "done", taken: null } as unknown as Study;

let root: Root;
let box: HTMLElement;
let taken: number[];

function show(study: Study) {
  act(() =>
    root.render(
      <MantineProvider env="test">
        <TakeOwn study={study} found={FOUND} onTake={(trial) => taken.push(trial)} busy={false} />
      </MantineProvider>,
    ),
  );
}

describe("thresholds that are proved at one speed", () => {
  beforeEach(() => {
    globalThis.IS_REACT_ACT_ENVIRONMENT = true;
    window.matchMedia ??= () => ({ matches: false, addEventListener() {}, removeEventListener() {} }) as never;
    taken = [];
    box = document.body.appendChild(document.createElement("div"));
    root = createRoot(box);
  });
  afterEach(() => {
    act(() => root.unmount());
    box.remove();
  });

  it("are taken each, and which one is taken is told", () => {
    show(STUDY);
    const [button, ...others] = [...box.querySelectorAll("button")];
    expect([button?.textContent, others]).toEqual(["Take that of 0.5 turns/s", []]);
    act(() => button?.click());
    expect(taken).toEqual([4]);
    expect(box.querySelector('[role="status"]')).toBeNull();
    show({ ...STUDY, taken: { trial: 4, proved: true } });
    expect(box.querySelector('[role="status"]')?.textContent).toBe("Taken: that of 0.5 turns/s.");
  });

  it("are not taken while the study runs", () => {
    show({ ...STUDY, state: "running" });
    expect(box.querySelectorAll("button")).toHaveLength(0);
  });
});
