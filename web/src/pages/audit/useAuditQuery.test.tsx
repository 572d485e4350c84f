// @vitest-environment jsdom
import { act } from "react";
import { createRoot, type Root } from "react-dom/client";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { EVERYTHING, type Filters } from "./filters";
import { useAuditQuery } from "./useAuditQuery";

declare global {
  var IS_REACT_ACT_ENVIRONMENT: boolean;
}

let root: Root;
let shown: ReturnType<typeof useAuditQuery>;
let renders: number;

/** Filters are another object each time, as those of an address are. */
function Asking({ filters }: { filters: Filters }) {
  shown = useAuditQuery({ ...filters });
  renders += 1;
  return null;
}

const show = (filters: Filters) => act(() => root.render(<Asking filters={filters} />));
const wait = (ms: number) => act(() => vi.advanceTimersByTime(ms));

describe("what is asked of the log", () => {
  beforeEach(() => {
    globalThis.IS_REACT_ACT_ENVIRONMENT = true;
    vi.useFakeTimers({ now: Date.UTC(2026, 0, 1, 12, 0, 30) });
    root = createRoot(document.createElement("div"));
    renders = 0;
  });
  afterEach(() => {
    act(() => root.unmount());
    vi.useRealTimers();
  });

  it("follows the filters when they stand still, and says that it is behind them", () => {
    show(EVERYTHING);
    expect(shown).toEqual({ query: {}, behind: false });
    show({ ...EVERYTHING, text: "st" });
    wait(100);
    show({ ...EVERYTHING, text: "stop" });
    wait(150);
    expect(shown).toEqual({ query: {}, behind: true });
    wait(100);
    expect(shown).toEqual({ query: { q: "stop" }, behind: false });
  });

  it("renders nothing anew while nothing changes", () => {
    for (let news = 0; news < 2; news++) show(EVERYTHING);
    for (let look = 0; look < 20; look++) wait(1_000);
    expect(renders).toBe(2);
  });

  it("asks for a span that ends now once a minute", () => {
    show({ ...EVERYTHING, span: "hour" });
    const first = shown.query.since;
    wait(20_000);
    expect(shown.query.since).toBe(first);
    wait(15_000);
    wait(1_000);
    expect(Date.parse(shown.query.since as string) - Date.parse(first as string)).toBe(60_000);
  });
});
