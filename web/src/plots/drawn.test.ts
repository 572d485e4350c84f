import { afterEach, describe, expect, it } from "vitest";
import { drawingAsSvg, plainColor } from "./drawn";

describe("a drawing that is saved", () => {
  afterEach(() => {
    document.body.replaceChildren();
    document.head.replaceChildren();
  });

  const saved = (html: string) => {
    document.body.innerHTML = `<div id="frame">${html}</div>`;
    const text = drawingAsSvg("Force < 2 N", document.getElementById("frame") as Element);
    return new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
  };

  it("has its look with it and nothing of the page's", () => {
    document.head.innerHTML = "<style>.line { stroke: red; opacity: 0.5 } .gone { display: none }</style>";
    const svg = saved(
      '<svg viewBox="0 0 9 9" class="big" role="img" tabindex="0" aria-label="Force" data-testid="it">' +
        '<path class="line" stroke="var(--accent)" d="M0 0h9"/><text class="gone">no</text><text x="1">yes</text></svg>' +
        "<button><svg><path d='M1 1'/></svg></button>",
    );
    const [drawing, ...others] = svg.querySelectorAll("svg");
    expect(others).toEqual([]);
    expect(drawing?.getAttribute("viewBox")).toBe("0 0 9 9");
    expect(svg.innerHTML).not.toMatch(/class|role|tabindex|aria-|data-|var\(/);
    const path = svg.querySelector("path");
    expect(path?.getAttribute("stroke")).toMatch(/^(red|rgb\(255, 0, 0\))$/);
    expect(path?.getAttribute("opacity")).toBe("0.5");
    expect([...svg.querySelectorAll("text")].map((each) => each.textContent)).toEqual(["Force < 2 N", "yes"]);
    expect(svg.querySelector("title")?.textContent).toBe("Force < 2 N");
  });

  it("writes mixed colours as all programs read them", () => {
    expect(plainColor("color(srgb 1 0.5 0)")).toBe("rgb(255, 128, 0)");
    expect(plainColor("color(srgb 0 0 1 / 0.22)")).toBe("rgba(0, 0, 255, 0.22)");
    expect(plainColor("rgb(1, 2, 3)")).toBe("rgb(1, 2, 3)");
  });
});
