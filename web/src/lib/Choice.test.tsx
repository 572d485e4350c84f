// @vitest-environment jsdom
import { MantineProvider } from "@mantine/core";
import { act, useState } from "react";
import { createRoot, type Root } from "react-dom/client";
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { Choice } from "./Choice";

const SPANS = [
  { value: "5", label: "5 s" },
  {
    group: "Long",
    items: [
      { value: "60", label: "1 min" },
      { value: "600", label: "10 min" },
    ],
  },
];

let root: Root;
let box: HTMLElement;
let chosen: string[];

function Held({ start }: { start: string | null }) {
  const [value, setValue] = useState(start);
  return (
    // "test" leaves out transitions: the list is there, and gone, at once
    <MantineProvider env="test">
      <Choice
        label="Span"
        data={SPANS}
        value={value}
        onChange={(next) => {
          chosen.push(next);
          setValue(next);
        }}
      />
    </MantineProvider>
  );
}

const field = () => box.querySelector("input") as HTMLInputElement;
const options = () => [...document.querySelectorAll<HTMLElement>('[role="option"]')];
const isOpen = () => field().getAttribute("aria-expanded") === "true";

function press(code: string) {
  const event = new KeyboardEvent("keydown", { key: code, code, bubbles: true, cancelable: true });
  act(() => {
    field().dispatchEvent(event);
  });
  return event;
}

function show(start: string | null) {
  act(() => root.render(<Held start={start} />));
  act(() => field().focus());
}

/** The label of the option that a screen reader is told of. */
function active() {
  const id = field().getAttribute("aria-activedescendant");
  return id === null ? null : document.getElementById(id)?.textContent;
}

beforeEach(() => {
  globalThis.IS_REACT_ACT_ENVIRONMENT = true;
  Element.prototype.scrollIntoView ??= () => {};
  window.matchMedia = (media) =>
    ({ media, matches: false, addEventListener() {}, removeEventListener() {} }) as unknown as MediaQueryList;
  box = document.body.appendChild(document.createElement("div"));
  root = createRoot(box);
  chosen = [];
});

afterEach(() => {
  act(() => root.unmount());
  box.remove();
});

describe("Choice", () => {
  it("shows the label of what is chosen, and nothing where that is none of its options", () => {
    show("600");
    expect(field().value).toBe("10 min");
    act(() => root.render(<Held key="none" start="7" />));
    expect(field().value).toBe("");
  });

  it("opens at the chosen option with an arrow, and goes on from there through its groups", () => {
    show("5");
    expect(press("ArrowDown").defaultPrevented).toBe(true);
    expect([isOpen(), active()]).toEqual([true, "5 s"]);
    expect(options().map((option) => option.getAttribute("aria-selected"))).toEqual(["true", "false", "false"]);
    press("ArrowDown");
    expect(active()).toBe("1 min");
    press("ArrowDown");
    expect(active()).toBe("10 min");
    press("ArrowUp");
    expect(active()).toBe("1 min");
    expect(chosen).toEqual([]);
  });

  it("takes the option that the arrows are at with Enter, and closes", () => {
    show("5");
    press("ArrowDown");
    press("ArrowDown");
    press("Enter");
    expect([chosen, isOpen(), field().value]).toEqual([["60"], false, "1 min"]);
    expect(document.activeElement).toBe(field());
  });

  it("opens with Enter and with Space", () => {
    show("60");
    press("Enter");
    expect([isOpen(), chosen]).toEqual([true, []]);
    press("Space");
    expect(isOpen()).toBe(false);
    press("Space");
    expect(isOpen()).toBe(true);
  });

  it("closes with Escape and leaves the choice as it was", () => {
    show("5");
    press("ArrowDown");
    press("ArrowDown");
    press("Escape");
    expect([isOpen(), chosen, field().value]).toEqual([false, [], "5 s"]);
    press("ArrowDown");
    expect(active()).toBe("5 s");
  });

  it("closes where the focus goes elsewhere", () => {
    show("5");
    press("ArrowDown");
    act(() => field().blur());
    expect([isOpen(), chosen]).toEqual([false, []]);
  });

  it("says in a sentence that there is nothing to choose", () => {
    act(() =>
      root.render(
        <MantineProvider env="test">
          <Choice label="Device" data={[]} value={null} empty="No device yet." onChange={() => {}} />
        </MantineProvider>,
      ),
    );
    act(() => field().click());
    expect([isOpen(), options().length]).toEqual([true, 0]);
    expect(document.querySelector('[role="listbox"]')?.textContent).toBe("No device yet.");
  });

  it("takes a click on an option", () => {
    show("5");
    act(() => field().click());
    expect(isOpen()).toBe(true);
    act(() => options()[2]?.click());
    expect([chosen, isOpen(), field().value]).toEqual([["600"], false, "10 min"]);
  });
});
