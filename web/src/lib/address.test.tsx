import { act } from "react";
import { createRoot } from "react-dom/client";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { addressWith, useAddressChoice, useAddressText } from "./address";

const seen: { find: string; tab: string } = { find: "", tab: "" };
let type: (text: string) => void = () => {};
let pick: (tab: "row" | "changes") => void = () => {};

function View() {
  const [find, setFind] = useAddressText("find");
  const [tab, setTab] = useAddressChoice("tab", ["row", "changes"]);
  Object.assign(seen, { find, tab });
  type = setFind;
  pick = setTab;
  return null;
}

describe("the address of a page", () => {
  it("takes texts in, leaves others alone, and has neither spaces nor plus", () => {
    const at = new URL("http://here/registers?d=xy&find=a");
    expect(addressWith({ find: "V MAX+1" }, at)).toBe("/registers?d=xy&find=V%20MAX%2B1");
    expect(addressWith({ find: "" }, at)).toBe("/registers?d=xy");
    expect(addressWith({ d: "", find: "" }, at)).toBe("/registers");
    expect(addressWith({ reg: "0/VMAX", rows: "position,load" }, at)).toBe(
      "/registers?d=xy&find=a&reg=0/VMAX&rows=position,load",
    );
  });

  it.each(["a&b=c", "100 %", "ä#?", "1+1", "%2C"])("gives %o back", (text) => {
    const address = addressWith({ find: text }, new URL("http://here/registers"));
    expect(new URL(address, "http://here").searchParams.get("find")).toBe(text);
  });

  describe("on a page", () => {
    const root = createRoot(document.createElement("div"));
    beforeEach(() => {
      vi.useFakeTimers({ toFake: ["setTimeout", "clearTimeout"] });
      window.history.replaceState(null, "", "/registers?find=vmax&tab=nonsense");
      act(() => root.render(<View />));
    });
    afterEach(() => {
      act(() => root.render(null));
      vi.useRealTimers();
      window.history.replaceState(null, "", "/");
    });

    it("says what is looked for, and the first choice in place of nonsense", () => {
      expect(seen).toEqual({ find: "vmax", tab: "row" });
    });

    it("follows typing when it has stood still, and a choice at once", () => {
      act(() => type("am"));
      act(() => type("amax"));
      expect(seen.find).toBe("amax");
      expect(location.search).toContain("find=vmax");
      act(() => vi.advanceTimersByTime(300));
      expect(location.search).toContain("find=amax");
      act(() => pick("changes"));
      expect(location.search).toBe("?find=amax&tab=changes");
      act(() => pick("row"));
      expect(location.search).toBe("?find=amax");
    });
  });
});
