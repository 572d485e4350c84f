// @vitest-environment jsdom
import { MantineProvider } from "@mantine/core";
import { act, useState } from "react";
import { createRoot, type Root } from "react-dom/client";
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import type { Study, Wish } from "../study";
import { FrontChoice } from "./FrontChoice";

declare global {
  var IS_REACT_ACT_ENVIRONMENT: boolean;
}

function trial(number: number, time: number, deviation: number) {
  const figures = { time_s: time, deviation_fullsteps: deviation, spread_s: null, lost_fullsteps: 0, runs: 1 };
  return {
    number,
    setting: { speed: 100 * number },
    registers: [],
    state: "feasible",
    figures,
    expected_s: 0.1,
    why: "",
  };
}

const STUDY = {
  id: "20260101-120000",
  state: "done",
  document: { device: "slide", axis: 0, study: { kind: "fastest_move", distance: 100, quiet: true } },
  units: { speed: "pps" },
  trials: [trial(1, 0.9, 0.1), trial(2, 0.5, 0.3), trial(3, 0.2, 0.9), trial(4, 0.95, 0.95)],
  front: [1, 2, 3],
  best: 2,
  improved: true,
} as unknown as Study;

let root: Root;
let box: HTMLElement;
let taken: number[];
let asked: Wish[];

function Held({ study }: { study: Study }) {
  const [number, setNumber] = useState(2);
  const chosen = study.trials.find((one) => one.number === number);
  return (
    <MantineProvider env="test">
      {chosen && (
        <FrontChoice
          study={study}
          chosen={chosen}
          onPick={setNumber}
          onTake={(one) => taken.push(one)}
          onProve={(proof) => asked.push(proof)}
          busy={false}
        />
      )}
    </MantineProvider>
  );
}

const radios = () => [...box.querySelectorAll<HTMLInputElement>('input[type="radio"]')];
const buttons = () => [...box.querySelectorAll("button")];
const click = (element: HTMLElement | undefined) => act(() => element?.click());

describe("the choice among a front", () => {
  beforeEach(() => {
    globalThis.IS_REACT_ACT_ENVIRONMENT = true;
    window.matchMedia ??= () => ({ matches: false, addEventListener() {}, removeEventListener() {} }) as never;
    [taken, asked] = [[], []];
    box = document.body.appendChild(document.createElement("div"));
    root = createRoot(box);
  });
  afterEach(() => {
    act(() => root.unmount());
    box.remove();
  });

  it("begins with the best one, which is proved, and takes it", () => {
    act(() => root.render(<Held study={STUDY} />));
    expect(radios().map(({ checked }) => checked)).toEqual([false, true, false]);
    expect(buttons().map(({ textContent }) => textContent)).toEqual(["Take trial 2"]);
    click(buttons()[0]);
    expect(taken).toEqual([2]);
  });

  it("takes another as not proved, or has it proved by a study of its own", () => {
    act(() => root.render(<Held study={STUDY} />));
    // one group: the arrow keys of the browser go from one to the next
    expect(new Set(radios().map(({ name }) => name)).size).toBe(1);
    click(radios()[0]);
    expect(radios().map(({ checked }) => checked)).toEqual([true, false, false]);
    expect(buttons().map(({ textContent }) => textContent)).toEqual([
      "Take trial 3 (not proved)",
      "Prove this one (moves)",
    ]);
    for (const button of buttons()) click(button);
    expect(taken).toEqual([3]);
    expect(asked).toMatchObject([{ device: "slide", study: { candidate: { speed: 300 }, quiet: true } }]);
  });

  it("offers nothing while the study runs", () => {
    act(() => root.render(<Held study={{ ...STUDY, state: "running" }} />));
    expect(radios()).toHaveLength(3);
    expect(buttons()).toEqual([]);
  });
});
