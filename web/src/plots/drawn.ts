import { coordinate } from "../lib/format";
import { TEXT_PX } from "./labels";
import { escaped } from "./SvgContext";

/** What a drawing's look is made of, and what it is where nothing says so; without that it comes from around it. */
const LOOKS: Readonly<Record<string, string | null>> = {
  fill: null,
  "fill-opacity": null,
  stroke: null,
  "stroke-width": null,
  "stroke-opacity": null,
  "stroke-dasharray": null,
  "stroke-linecap": null,
  "stroke-linejoin": null,
  visibility: null,
  "font-family": null,
  "font-size": null,
  "font-weight": null,
  "text-anchor": null,
  "paint-order": null,
  "dominant-baseline": "auto",
  opacity: "1",
  "vector-effect": "none",
};
const ONLY_OF_PAGES = /^(class|style|role|tabindex|focusable|(aria|data)-.*)$/;
const EDGE_PX = 8;
const HEAD_PX = 20;

/** Programs that draw do not know the colours that a mixed one is computed to. */
export function plainColor(value: string): string {
  return value.replace(/color\(srgb ([\d.]+) ([\d.]+) ([\d.]+)(?: \/ ([\d.]+))?\)/g, (_, red, green, blue, alpha) => {
    const parts = [red, green, blue].map((part) => Math.round(Number(part) * 255));
    return alpha === undefined ? `rgb(${parts.join(", ")})` : `rgba(${[...parts, alpha].join(", ")})`;
  });
}

/** The same element without the page around it: how it looks stands with it. */
function alone(source: Element, around?: CSSStyleDeclaration): Element | null {
  const look = getComputedStyle(source);
  if (look.display === "none") return null;
  const copy = source.cloneNode(false) as Element;
  for (const { name } of [...copy.attributes])
    if (ONLY_OF_PAGES.test(name) || name in LOOKS) copy.removeAttribute(name);
  for (const [name, initial] of Object.entries(LOOKS)) {
    const value = look.getPropertyValue(name);
    if (value !== "" && value !== (initial ?? around?.getPropertyValue(name)))
      copy.setAttribute(name, plainColor(value));
  }
  for (const node of source.childNodes) {
    const part = node instanceof Element ? alone(node, look) : node.cloneNode();
    if (part !== null) copy.append(part);
  }
  return copy;
}

/** A legend's words and what they are told apart by, each where it stands. */
function legend(caption: Element, x: number, y: number): string[] {
  const parts: string[] = [];
  const at = (value: number) => coordinate(value, 1);
  for (const element of caption.querySelectorAll<HTMLElement>(":not(svg, svg *)")) {
    const { backgroundColor, borderTopColor, borderTopStyle, borderTopWidth } = getComputedStyle(element);
    const { left, top, width, height } = element.getBoundingClientRect();
    const line = borderTopStyle === "none" ? "none" : plainColor(borderTopColor);
    parts.push(
      `<path d="M${at(left - x)} ${at(top - y)}h${at(width)}v${at(height)}h${at(-width)}Z" fill="${plainColor(backgroundColor)}" ` +
        `stroke="${line}" stroke-width="${borderTopWidth}"${borderTopStyle === "dashed" ? ' stroke-dasharray="4 3"' : ""}/>`,
    );
  }
  const nodes = document.createTreeWalker(caption, NodeFilter.SHOW_TEXT);
  for (let node = nodes.nextNode() as Text | null; node; node = nodes.nextNode() as Text | null) {
    const look = getComputedStyle(node.parentElement ?? caption);
    for (const { 0: word, index } of node.data.matchAll(/\S+/g)) {
      const range = document.createRange();
      range.setStart(node, index);
      range.setEnd(node, index + word.length);
      const { left, top, height } = range.getBoundingClientRect();
      parts.push(
        `<text x="${at(left - x)}" y="${at(top + height / 2 - y)}" dominant-baseline="central" fill="${plainColor(look.color)}" ` +
          `font-size="${look.fontSize}" font-weight="${look.fontWeight}">${escaped(word)}</text>`,
      );
    }
  }
  return parts;
}

/** All drawings in `frame` as one that stands alone: as large as they are seen, with a title, on the page's ground. */
export function drawingAsSvg(title: string, frame: Element, style = ""): string {
  const { backgroundColor, color, fontFamily } = getComputedStyle(document.body);
  const drawn = [...frame.querySelectorAll("svg, figcaption")].filter((each) => each.closest("button") === null);
  const boxes = drawn.map((each) => each.getBoundingClientRect());
  const x = Math.min(...boxes.map(({ left }) => left)) - EDGE_PX;
  const y = Math.min(...boxes.map(({ top }) => top)) - HEAD_PX - EDGE_PX;
  const width = Math.ceil(Math.max(...boxes.map(({ right }) => right)) - x + EDGE_PX);
  const height = Math.ceil(Math.max(...boxes.map(({ bottom }) => bottom)) - y + EDGE_PX);
  const parts = drawn.flatMap((each, index) => {
    if (!(each instanceof SVGSVGElement)) return legend(each, x, y);
    const copy = alone(each);
    const { left = 0, top = 0, width: wide = 0, height: high = 0 } = boxes[index] ?? {};
    for (const [name, value] of Object.entries({ x: left - x, y: top - y, width: wide, height: high }))
      copy?.setAttribute(name, coordinate(value, 1));
    return copy === null ? [] : [new XMLSerializer().serializeToString(copy)];
  });
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-family="${escaped(fontFamily)}">`,
    `<title>${escaped(title)}</title>${style}`,
    `<rect width="100%" height="100%" fill="${plainColor(backgroundColor)}"/>`,
    `<text x="${EDGE_PX}" y="${HEAD_PX - 4}" font-size="${TEXT_PX}" font-weight="600" fill="${plainColor(color)}">${escaped(title)}</text>`,
    ...parts,
    "</svg>",
  ].join("\n");
}
