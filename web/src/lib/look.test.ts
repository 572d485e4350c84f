import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { followDensity, look } from "./look";

describe("how dense the page is", () => {
  const finger = Object.assign(new EventTarget(), { matches: false });
  const root = document.createElement("html");
  beforeEach(() => vi.stubGlobal("matchMedia", () => finger));
  afterEach(() => {
    vi.unstubAllGlobals();
    look.set({ density: "auto", clock: "local" });
  });

  it("goes by the pointer until somebody chooses", () => {
    followDensity(root);
    expect(root.dataset.density).toBe("dense");
    finger.matches = true;
    finger.dispatchEvent(new Event("change"));
    expect(root.dataset.density).toBe("touch");
    look.set({ ...look.get(), density: "normal" });
    expect(root.dataset.density).toBe("normal");
    expect(JSON.parse(localStorage.getItem("stepscope.look") ?? "")).toEqual({ density: "normal", clock: "local" });
  });
});
