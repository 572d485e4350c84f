// @vitest-environment jsdom
import { MantineProvider } from "@mantine/core";
import { act, useState } from "react";
import { createRoot, type Root } from "react-dom/client";
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { NumberField, type NumberFieldProps } from "./NumberField";

declare global {
  var IS_REACT_ACT_ENVIRONMENT: boolean;
}

let root: Root;
let box: HTMLElement;
let sent: number[];

function Held({ start, ...props }: { start: number } & Partial<NumberFieldProps>) {
  const [value, setValue] = useState(start);
  return (
    <MantineProvider>
      <NumberField
        {...props}
        value={value}
        onChange={(next) => {
          sent.push(next);
          setValue(next);
        }}
      />
    </MantineProvider>
  );
}

const field = () => box.querySelector("input") as HTMLInputElement;

function type(text: string) {
  act(() => {
    Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value")?.set?.call(field(), text);
    field().dispatchEvent(new Event("input", { bubbles: true }));
  });
}

const press = (key: string) => act(() => field().dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true })));

function show(start: number, props: Partial<NumberFieldProps> = {}) {
  act(() => root.render(<Held key={Math.random()} start={start} {...props} />));
}

/** Numbers as people type them, over the whole range of a float and of a 32-bit register; the same in every run. */
function* typed(count: number): Generator<string> {
  let seed = 1;
  const next = (below: number) => {
    seed = (seed * 48_271) % 2_147_483_647;
    return seed % below;
  };
  for (let at = 0; at < count; at++) {
    const digits = Array.from({ length: 1 + next(15) }, () => next(10)).join("");
    const point = next(digits.length + 1);
    const sign = next(2) === 0 ? "" : "-";
    yield `${sign}${digits.slice(0, point) || "0"}${next(3) === 0 ? "" : `.${digits.slice(point)}`}`;
  }
}

beforeEach(() => {
  globalThis.IS_REACT_ACT_ENVIRONMENT = true;
  window.matchMedia = (media) =>
    ({ media, matches: false, addEventListener() {}, removeEventListener() {} }) as unknown as MediaQueryList;
  sent = [];
  box = document.body.appendChild(document.createElement("div"));
  root = createRoot(box);
});

afterEach(() => {
  act(() => root.unmount());
  box.remove();
});

describe("a number field", () => {
  it("reports what is typed, whatever its look rounds", () => {
    const coarse = (value: number) => value.toPrecision(3);
    let took = 0;
    for (const show_ of [undefined, coarse]) {
      show(0.5, show_ ? { show: show_ } : {});
      for (const text of typed(12)) {
        sent = [];
        type(text);
        press("Enter");
        // the same number again is no news
        if (sent.length > 0) expect(sent).toEqual([Number(text)]);
        act(() => field().focus());
        expect(Number(field().value)).toBeCloseTo(Number(text), 12);
        act(() => field().blur());
        took += sent.length;
        expect(sent.length).toBeLessThanOrEqual(1);
      }
    }
    expect(took).toBeGreaterThan(15);
  });

  it("does not send its rounding when nobody has typed anything new", () => {
    show(1 / 3, { show: (value) => value.toFixed(2) });
    expect(field().value).toBe("0.33");
    act(() => field().focus());
    expect(field().value).toBe("0.3333333333333333");
    type("0.33333333333333");
    type("0.3333333333333333");
    press("Enter");
    expect(sent).toEqual([]);
    press("ArrowUp");
    expect(sent[0]).toBeCloseTo(4 / 3, 13);
  });

  it("keeps what is selected when it shows every digit", () => {
    const selected = () => field().value.slice(field().selectionStart ?? 0, field().selectionEnd ?? 0);
    show(1 / 3, { show: (value) => value.toFixed(2) });
    globalThis.IS_REACT_ACT_ENVIRONMENT = false; // as in a browser: what selects the text once it is in finds all of it
    field().focus();
    expect(selected()).toBe("0.3333333333333333");
    field().blur();
    field().dispatchEvent(new Event("pointerdown", { bubbles: true }));
    field().setSelectionRange(0, 0);
    field().focus();
    expect(selected()).toBe("");
    globalThis.IS_REACT_ACT_ENVIRONMENT = true;
  });

  it("keeps all eight digits of a position", () => {
    show(0);
    type("12345678");
    press("Enter");
    expect([sent, field().value]).toEqual([[12_345_678], "12345678"]);
  });

  it("begins something with what stands there now, and with nothing that was refused", () => {
    const begun: number[] = [];
    const wrong: boolean[] = [];
    show(5, { max: 100, onEnter: (value) => begun.push(value), onWrong: (is) => wrong.push(is) });
    type("42");
    press("Enter");
    type("4200");
    press("Enter");
    expect([begun, wrong]).toEqual([[42], [true]]);
    type("7");
    press("Enter");
    expect([begun, wrong]).toEqual([
      [42, 7],
      [true, false],
    ]);
  });

  it("refuses digits that it cannot hold", () => {
    show(0);
    type("9007199254740993");
    press("Enter");
    expect(sent).toEqual([]);
    expect(box.textContent).toContain("2^53");
  });
});
