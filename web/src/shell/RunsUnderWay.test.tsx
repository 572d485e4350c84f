// @vitest-environment jsdom
import { MantineProvider } from "@mantine/core";
import { QueryClient, QueryClientProvider } from "@tanstack/react-query";
import { act } from "react";
import { createRoot, type Root } from "react-dom/client";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { motion } from "../api/motion";
import { runOf } from "../pages/module/heldRuns";
import { RunsUnderWay } from "./RunsUnderWay";

describe("a run behind another page", () => {
  let root: Root;
  let at: HTMLElement;
  const shown = () => at.querySelector("[data-testid^=run-]")?.textContent ?? "";
  const goTo = (page: string) => act(async () => window.history.replaceState(null, "", page));

  beforeEach(async () => {
    globalThis.IS_REACT_ACT_ENVIRONMENT = true;
    window.matchMedia = () => ({ matches: false, addEventListener: vi.fn(), removeEventListener: vi.fn() }) as never;
    vi.spyOn(motion, "rotate").mockResolvedValue(undefined as never);
    vi.spyOn(motion, "stop").mockResolvedValue(undefined as never);
    at = document.body.appendChild(document.createElement("div"));
    root = createRoot(at);
    await goTo("/stallguard");
    await act(async () =>
      root.render(
        <QueryClientProvider client={new QueryClient()}>
          <MantineProvider>
            <RunsUnderWay />
          </MantineProvider>
        </QueryClientProvider>,
      ),
    );
  });
  afterEach(async () => {
    await act(async () => root.unmount());
    at.remove();
    vi.restoreAllMocks();
  });

  it("is told while it goes on, and when it ended by itself, until that was seen", async () => {
    const run = runOf({ device: "bench", axis: 0 });
    await act(async () => run.start([{ velocityPps: 1, forS: 9 }]));
    expect(run.untold()).toBeNull();
    expect(shown()).toBe("");
    await goTo("/connections");
    expect(shown()).toContain("bench 0 still turns, part 1 of 1.");
    await act(async () => run.run.stuck("stall"));
    expect(run.untold()).toBe("Ended: stall.");
    expect(shown()).toContain("bench 0 no longer turns as begun. Ended: stall.");
    await act(async () => run.seen());
    expect(shown()).toBe("");
  });
});
