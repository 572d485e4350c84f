import { describe, expect, it } from "vitest";
import { SvgContext, TextPath } from "./SvgContext";

describe("a context that writes SVG", () => {
  const context = () => new SvgContext(document.createElement("canvas"));
  const drawn = (of: SvgContext) => of as unknown as CanvasRenderingContext2D & SvgContext;

  it("keeps lines, their look and the clip around them", () => {
    const ctx = drawn(context());
    ctx.save();
    ctx.beginPath();
    ctx.rect(0, 0, 100, 50);
    ctx.clip();
    ctx.beginPath();
    ctx.moveTo(1, 2);
    ctx.lineTo(3.456, 4);
    ctx.strokeStyle = "#0068a8";
    ctx.setLineDash([4, 3]);
    ctx.stroke();
    ctx.restore();
    expect(ctx.toString().split("\n")).toEqual([
      '<clipPath id="clip1"><path d="M0 0h100v50h-100Z"/></clipPath>',
      '<path d="M1 2L3.46 4" fill="none" stroke="#0068a8" stroke-width="1" stroke-linejoin="miter" ' +
        'stroke-linecap="butt" stroke-dasharray="4 3" clip-path="url(#clip1)"/>',
    ]);
    expect(ctx.strokeStyle).toBe("#000");
  });

  it("keeps texts with their place, and nothing of theirs is taken for SVG", () => {
    const ctx = drawn(context());
    ctx.font = '600 12px Inter, "Other"';
    ctx.textAlign = "right";
    ctx.textBaseline = "middle";
    ctx.fillText("a < b & c", 10, 20);
    expect(ctx.toString()).toContain('text-anchor="end" dominant-baseline="central"');
    expect(ctx.toString()).toContain("a &lt; b &amp; c</text>");
    const read = new DOMParser().parseFromString(
      `<svg xmlns="http://www.w3.org/2000/svg">${ctx}</svg>`,
      "image/svg+xml",
    );
    expect(read.querySelector("text")?.textContent).toBe("a < b & c");
    expect(read.querySelector("text")?.getAttribute("style")).toContain("12px");
  });

  it("takes paths that were made before", () => {
    const path = new TextPath();
    path.arc(10, 10, 4);
    const ctx = context();
    ctx.fill(path);
    ctx.fill(new TextPath());
    expect(ctx.toString()).toBe('<path d="M6 10a4 4 0 1 0 8 0a4 4 0 1 0 -8 0Z" fill="#000"/>');
  });
});
