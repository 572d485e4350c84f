// @vitest-environment jsdom
import { act } from "react";
import { createRoot, type Root } from "react-dom/client";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { useHeld } from "./useHeld";

declare global {
  var IS_REACT_ACT_ENVIRONMENT: boolean;
}

let root: Root;
let box: HTMLElement;
let sent: number[];

/** A slider as an emulator's panel has it: a key goes one step on from what is shown. */
function Slider({ server }: { server: number }) {
  const [shown, hold] = useHeld(server);
  const step = () => {
    const next = shown + 1;
    hold(next);
    sent.push(next);
  };
  return (
    <button type="button" onKeyDown={step}>
      {shown}
    </button>
  );
}

const show = (server: number) => act(() => root.render(<Slider server={server} />));
const press = () =>
  act(() => box.querySelector("button")?.dispatchEvent(new KeyboardEvent("keydown", { bubbles: true })));

describe("a value held by the hand", () => {
  beforeEach(() => {
    globalThis.IS_REACT_ACT_ENVIRONMENT = true;
    vi.useFakeTimers();
    box = document.createElement("div");
    document.body.append(box);
    root = createRoot(box);
    sent = [];
  });
  afterEach(() => {
    act(() => root.unmount());
    box.remove();
    vi.useRealTimers();
  });

  it("loses no key press while the server's answers are on their way", () => {
    show(0);
    for (let pressed = 0; pressed < 5; pressed++) press();
    show(1); // the answer to the first
    for (let pressed = 0; pressed < 5; pressed++) press();
    expect(sent).toEqual([1, 2, 3, 4, 5, 6, 7, 8, 9, 10]);
    expect(box.textContent).toBe("10");
  });

  it("follows the server once its answer is here", () => {
    show(0);
    press();
    show(1);
    show(7);
    expect(box.textContent).toBe("7");
  });

  it("shows what the server has where no answer comes", () => {
    show(0);
    press();
    expect(box.textContent).toBe("1");
    act(() => vi.advanceTimersByTime(2000));
    expect(box.textContent).toBe("0");
  });
});
