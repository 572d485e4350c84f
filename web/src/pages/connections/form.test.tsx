// @vitest-environment jsdom
import { MantineProvider } from "@mantine/core";
import { act } from "react";
import { createRoot, type Root } from "react-dom/client";
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { MODELS } from "../../../test/catalog";
import openapi from "../../api/openapi.json";
import type { Entry } from "./fields";
import { AXIS_FIELDS, type Field, type Form, fieldsOf, linkForm, problemsIn, wanted, written } from "./form";
import { LinkFields } from "./LinkFields";

declare global {
  var IS_REACT_ACT_ENVIRONMENT: boolean;
}

type Property = { title?: string; form?: { rest_only?: boolean } };
const SCHEMAS = openapi.components.schemas as unknown as Record<string, { properties: Record<string, Property> }>;

describe("what the forms are made of", () => {
  it("has a form for each kind of link of each model, and every field says what it is", () => {
    for (const model of MODELS)
      for (const { kind } of model.wires) {
        const fields = fieldsOf(linkForm(model, kind), model.axes);
        expect(fields.length, `${model.name} ${kind}`).toBeGreaterThan(0);
        for (const field of [...fields, ...AXIS_FIELDS]) {
          expect(field.title, field.path).toMatch(/^[A-Z]/);
          if (field.type !== "string") expect(wanted(field), field.path).not.toBe("");
        }
      }
  });

  it("leaves out no field of a link but those that say so", () => {
    const paths = AXIS_FIELDS.map(({ path }) => path.split(".")[0]);
    expect([...new Set(paths)]).toEqual(Object.keys(SCHEMAS.AxisConfig?.properties ?? {}));
    const uart = MODELS.find(({ name }) => name === "tmc5160");
    const shown = uart && fieldsOf(linkForm(uart, "uart")).map(({ path }) => path);
    expect(["kind", ...(shown ?? [])]).toEqual(Object.keys(SCHEMAS.UartLink?.properties ?? {}));
  });
});

/** A form as it would be with one field more in the link's model, of which the page has never heard. */
const GUARD: Field = {
  path: "guard_us",
  title: "Guard time",
  type: "integer",
  help: "silence between two frames",
  unit: "µs",
  default: 40,
  minimum: 10,
  maximum: 900,
};
const MODE: Field = {
  path: "deep.mode",
  title: "Mode",
  type: "string",
  default: "slow",
  options: [
    { value: "slow", label: "slow: as it was" },
    { value: "fast", label: "fast" },
  ],
};
const FORM: Form = { groups: [{ title: "", help: "A made-up link.", fields: [GUARD, MODE] }] };

describe("a field that the server has and the page does not know", () => {
  let root: Root;
  let box: HTMLElement;
  beforeEach(() => {
    globalThis.IS_REACT_ACT_ENVIRONMENT = true;
    window.matchMedia = () => ({ matches: false, addEventListener() {}, removeEventListener() {} }) as never;
    globalThis.ResizeObserver = class {
      observe() {}
      unobserve() {}
      disconnect() {}
    };
    box = document.body.appendChild(document.createElement("div"));
    root = createRoot(box);
  });
  afterEach(() => {
    act(() => root.unmount());
    box.remove();
  });

  it("is shown with its label, unit, default and choices, and told what it is for when it is entered", () => {
    const entry: Entry = { value: () => "", problem: () => undefined, onChange: () => undefined };
    act(() =>
      root.render(
        <MantineProvider env="test">
          <LinkFields form={FORM} names={[]} open onOpen={() => undefined} {...entry} />
        </MantineProvider>,
      ),
    );
    expect(box.textContent).toContain("A made-up link.");
    const [guard, mode] = box.querySelectorAll("input");
    expect(box.querySelector(`label[for="${guard?.id}"]`)?.textContent).toBe("Guard time [µs]");
    expect(guard?.placeholder).toBe("40");
    expect(guard?.getAttribute("aria-description")).toBe("silence between two frames; a whole number, 10 to 900");
    expect(mode?.value).toBe("slow: as it was");
    act(() => guard?.focus());
    expect(box.textContent).toContain("Guard time: silence between two frames; a whole number, 10 to 900");
  });

  it("is held to its bounds, and sent when it was said", () => {
    const fields = fieldsOf(FORM);
    const problem = (text: string) => problemsIn(fields, { guard_us: text })[0]?.[1];
    expect(problem("")).toBeUndefined();
    expect(problem("900")).toBeUndefined();
    for (const text of ["9", "901", "40.5"]) expect(problem(text)).toBe("Wanted: a whole number, 10 to 900");
    expect(problem("long")).toContain("Not a number");
    expect(written({ kind: "new", kept: 1 }, FORM, { guard_us: "50", "deep.mode": "fast" })).toEqual({
      kind: "new",
      kept: 1,
      guard_us: 50,
      deep: { mode: "fast" },
    });
    expect(written({ kind: "new", guard_us: 3 }, FORM, {})).toEqual({ kind: "new" });
  });

  it("of objects in a list is written beside the others of that axis", () => {
    const groups = ["guard_us", "deep.mode"].map((path) => ({
      title: path,
      help: "",
      list: "each",
      fields: [GUARD, MODE].filter((field) => field.path === path),
    }));
    const typed = { "each.0.guard_us": "50", "each.1.deep.mode": "fast" };
    const both = { each: [{ guard_us: 50 }, { deep: { mode: "fast" } }] };
    expect(written({}, { groups }, typed, 2)).toEqual(both);
    expect(written(both, { groups }, { "each.1.deep.mode": "fast" }, 2)).toEqual({
      each: [{}, { deep: { mode: "fast" } }],
    });
    expect(written(both, { groups }, {}, 2)).toEqual({});
  });
});
