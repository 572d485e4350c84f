import uPlot from "uplot";
import { FAMILY, interUrl } from "../font";
import { fileName, saveBlob } from "../lib/files";
import { symbolOf } from "../lib/units";
import { drawingAsSvg } from "./drawn";
import { TEXT_PX } from "./labels";
import { type Build, buildOptions } from "./options";
import { escaped, SvgContext, TextPath } from "./SvgContext";
import type { PlotSeries } from "./types";

/** What a picture is to be saved of: a plot, or what is drawn in a frame of the page. */
export type Subject = OfPlot | { title: string; frame: Element };

interface OfPlot {
  title: string;
  plot: uPlot;
  build: Build;
}

const LINE_PX = 20;
const EDGE_PX = 8;
const SWATCH_PX = 16;

/** The picture as it is seen, with its title and legend, in the colours of the page. */
export async function savePng(subject: Subject): Promise<void> {
  const blob = await ("plot" in subject ? plotAsPng(subject) : drawingAsPng(subject.title, subject.frame));
  saveBlob(fileName(subject.title, ".png"), blob);
}

/** The same as lines and text: a plot drawn anew from the same data, a drawing as it is. */
export function saveSvg(subject: Subject): void {
  const text = "plot" in subject ? plotAsSvg(subject) : drawingAsSvg(subject.title, subject.frame);
  saveBlob(fileName(subject.title, ".svg"), new Blob([text], { type: "image/svg+xml" }));
}

function page(): { ground: string; ink: string } {
  const { backgroundColor, color } = getComputedStyle(document.body);
  return { ground: backgroundColor, ink: color };
}

interface Word {
  text: string;
  color?: string;
  x: number;
  line: number;
}

/** Title and legend, in as many lines as they need; returns their height in device pixels. */
function drawHead(ctx: CanvasRenderingContext2D, title: string, series: readonly PlotSeries[], ratio: number): number {
  const { ground, ink } = page();
  const { width, height } = ctx.canvas;
  const font = (word: Word) => `${word.color ? "" : "600 "}${TEXT_PX * ratio}px ${FAMILY}`;
  const named = series.filter(({ unnamed, hidden }) => !(unnamed || hidden));
  const words: Word[] = [
    { text: title, x: 0, line: 0 },
    ...named.map(({ label, unit = "", color }) => ({
      text: [label, symbolOf(unit)].filter(Boolean).join(" "),
      color,
      x: 0,
      line: 0,
    })),
  ];
  let [x, line] = [EDGE_PX * ratio, 0];
  for (const word of words) {
    ctx.font = font(word);
    const wide = ctx.measureText(word.text).width + (word.color ? SWATCH_PX : 0) * ratio;
    if (x > EDGE_PX * ratio && x + wide > width) [x, line] = [EDGE_PX * ratio, line + 1];
    Object.assign(word, { x, line });
    x += wide + 12 * ratio;
  }
  const head = (line + 1) * LINE_PX * ratio;
  ctx.fillStyle = ground;
  ctx.fillRect(0, 0, width, height + head);
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  for (const word of words) {
    const middle = (word.line + 0.5) * LINE_PX * ratio;
    if (word.color) {
      ctx.fillStyle = word.color;
      ctx.fillRect(word.x, middle - 1.5 * ratio, 12 * ratio, 3 * ratio);
    }
    ctx.font = font(word);
    ctx.fillStyle = ink;
    ctx.fillText(word.text, word.x + (word.color ? SWATCH_PX * ratio : 0), middle);
  }
  return head;
}

async function plotAsPng({ title, plot, build }: OfPlot): Promise<Blob> {
  const ratio = window.devicePixelRatio || 1;
  const drawn = plot.ctx.canvas;
  const canvas = document.createElement("canvas");
  const ctx = canvas.getContext("2d");
  if (ctx === null) throw new Error("this browser draws no picture");
  canvas.width = drawn.width;
  // how high the head is is known once it was drawn
  const top = drawHead(ctx, title, build.series, ratio);
  canvas.height = drawn.height + top;
  drawHead(ctx, title, build.series, ratio);
  ctx.drawImage(drawn, 0, top);
  return blobOf(canvas);
}

/** The plot drawn once more, with the same data and scales, onto what keeps lines and text instead of pixels. */
function plotAsSvg({ title, plot, build }: OfPlot): string {
  const ratio = window.devicePixelRatio || 1;
  const { width, height } = plot.ctx.canvas;
  const head = new SvgContext(plot.ctx.canvas);
  const top = drawHead(head as unknown as CanvasRenderingContext2D, title, build.series, ratio);
  const body = redrawn(plot, build);
  const [wide, high] = [width, height + top];
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${wide / ratio}" height="${high / ratio}" viewBox="0 0 ${wide} ${high}">`,
    `<title>${escaped(title)}</title>`,
    head.toString(),
    `<g transform="translate(0 ${top})">`,
    body,
    "</g>",
    "</svg>",
  ].join("\n");
}

function redrawn(plot: uPlot, build: Build): string {
  const { Path2D: OfPixels } = globalThis;
  const { getContext } = HTMLCanvasElement.prototype;
  let context: SvgContext | undefined;
  // uPlot makes its canvas and its paths by itself: for the moment of one drawing both are ours
  HTMLCanvasElement.prototype.getContext = function contextOf(this: HTMLCanvasElement) {
    context = new SvgContext(this);
    return context as unknown as CanvasRenderingContext2D;
  } as unknown as typeof getContext;
  globalThis.Path2D = TextPath as unknown as typeof Path2D;
  try {
    const copy = new uPlot(
      { ...buildOptions(build), hooks: { drawClear: plot.hooks.drawClear ?? [] } },
      plot.data,
      document.createElement("div"),
    );
    HTMLCanvasElement.prototype.getContext = getContext;
    copy.batch(() => {
      for (const [key, { min, max }] of Object.entries(plot.scales))
        if (min != null && max != null) copy.setScale(key, { min, max });
    });
    copy.destroy();
  } finally {
    HTMLCanvasElement.prototype.getContext = getContext;
    globalThis.Path2D = OfPixels;
  }
  return context?.toString() ?? "";
}

/** The page's font as text. An image sees no other than what is within it; another is legible too. */
async function fontStyle(): Promise<string> {
  const answer = await fetch(interUrl()).catch(() => null);
  if (!answer?.ok) return "";
  const bytes = new Uint8Array(await answer.arrayBuffer());
  const source = `data:font/woff2;base64,${btoa(String.fromCharCode(...bytes))}`;
  return `<style>@font-face{font-family:Inter;font-weight:400 600;src:url(${source})}</style>`;
}

async function drawingAsPng(title: string, frame: Element): Promise<Blob> {
  const ratio = Math.max(2, window.devicePixelRatio);
  const image = new Image();
  image.src = `data:image/svg+xml,${encodeURIComponent(drawingAsSvg(title, frame, await fontStyle()))}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  canvas.width = image.naturalWidth * ratio;
  canvas.height = image.naturalHeight * ratio;
  canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
  return blobOf(canvas);
}

async function blobOf(canvas: HTMLCanvasElement): Promise<Blob> {
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, "image/png"));
  if (blob === null) throw new Error("this browser makes no picture of it");
  return blob;
}
