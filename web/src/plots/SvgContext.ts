import { coordinate } from "../lib/format";

/** A path as the text of an SVG's `d`: what a canvas takes as Path2D, for a drawing that is kept as text. */
export class TextPath {
  d = "";

  constructor(other?: TextPath) {
    if (other) this.d = other.d;
  }

  moveTo(x: number, y: number) {
    this.d += `M${place(x)} ${place(y)}`;
  }

  /** Without a place to come from it begins there, as Path2D does. */
  lineTo(x: number, y: number) {
    this.d += `${this.d === "" ? "M" : "L"}${place(x)} ${place(y)}`;
  }

  rect(x: number, y: number, width: number, height: number) {
    this.d += `M${place(x)} ${place(y)}h${place(width)}v${place(height)}h${place(-width)}Z`;
  }

  /** A whole circle: of arcs, plots draw no other. */
  arc(x: number, y: number, radius: number) {
    const [r, far] = [place(radius), place(2 * radius)];
    this.d += `M${place(x - radius)} ${place(y)}a${r} ${r} 0 1 0 ${far} 0a${r} ${r} 0 1 0 -${far} 0Z`;
  }

  closePath() {
    this.d += "Z";
  }

  addPath(other: TextPath) {
    this.d += other.d;
  }
}

const place = (value: number) => coordinate(value).replace(/\.?0+$/, "");

const BASELINES: Partial<Record<CanvasTextBaseline, string>> = {
  top: "text-before-edge",
  middle: "central",
  bottom: "text-after-edge",
};
const ANCHORS: Partial<Record<CanvasTextAlign, string>> = { center: "middle", right: "end", end: "end" };

type Matrix = readonly [number, number, number, number, number, number];

interface State {
  fillStyle: string;
  strokeStyle: string;
  lineWidth: number;
  lineJoin: string;
  lineCap: string;
  globalAlpha: number;
  font: string;
  textAlign: CanvasTextAlign;
  textBaseline: CanvasTextBaseline;
  dash: number[];
  matrix: Matrix;
  within: string;
}

const FRESH: State = {
  fillStyle: "#000",
  strokeStyle: "#000",
  lineWidth: 1,
  lineJoin: "miter",
  lineCap: "butt",
  globalAlpha: 1,
  font: `10px sans-serif`,
  textAlign: "left",
  textBaseline: "alphabetic",
  dash: [],
  matrix: [1, 0, 0, 1, 0, 0],
  within: "",
};

/** As much of a canvas's context as plots draw with, which writes SVG instead of setting pixels. */
export class SvgContext {
  private readonly parts: string[] = [];
  private readonly stack: State[] = [];
  private state: State = { ...FRESH };
  private path = new TextPath();
  private clips = 0;

  constructor(readonly canvas: HTMLCanvasElement) {
    // the settings of a context are properties: each is kept with its state
    for (const key of Object.keys(FRESH) as (keyof State)[])
      Object.defineProperty(this, key, {
        get: () => this.state[key],
        set: (value: never) => {
          this.state[key] = value;
        },
      });
  }

  /** What was drawn, as elements of an SVG. */
  toString(): string {
    return this.parts.join("\n");
  }

  save() {
    this.stack.push({ ...this.state });
  }

  restore() {
    this.state = this.stack.pop() ?? { ...FRESH };
  }

  translate(x: number, y: number) {
    const [a, b, c, d, e, f] = this.state.matrix;
    this.state.matrix = [a, b, c, d, e + a * x + c * y, f + b * x + d * y];
  }

  rotate(angle: number) {
    const [a, b, c, d, e, f] = this.state.matrix;
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    this.state.matrix = [a * cos + c * sin, b * cos + d * sin, c * cos - a * sin, d * cos - b * sin, e, f];
  }

  setLineDash(dash: number[]) {
    this.state.dash = [...dash];
  }

  beginPath() {
    this.path = new TextPath();
  }

  moveTo(x: number, y: number) {
    this.path.moveTo(x, y);
  }

  lineTo(x: number, y: number) {
    this.path.lineTo(x, y);
  }

  rect(x: number, y: number, width: number, height: number) {
    this.path.rect(x, y, width, height);
  }

  clearRect() {
    // a picture begins empty
  }

  clip(path: TextPath = this.path) {
    this.clips += 1;
    const id = `clip${this.clips}`;
    this.parts.push(`<clipPath id="${id}"${this.where()}><path d="${path.d}"/></clipPath>`);
    this.state.within = id;
  }

  stroke(path: TextPath = this.path) {
    const { strokeStyle, lineWidth, lineJoin, lineCap, dash } = this.state;
    if (path.d === "" || lineWidth === 0) return;
    const form = dash.length > 0 ? ` stroke-dasharray="${dash.map(place).join(" ")}"` : "";
    this.parts.push(
      `<path d="${path.d}" fill="none" stroke="${strokeStyle}" stroke-width="${place(lineWidth)}" ` +
        `stroke-linejoin="${lineJoin}" stroke-linecap="${lineCap}"${form}${this.where()}/>`,
    );
  }

  fill(path: TextPath = this.path) {
    if (path.d !== "") this.parts.push(`<path d="${path.d}" fill="${this.state.fillStyle}"${this.where()}/>`);
  }

  fillRect(x: number, y: number, width: number, height: number) {
    const path = new TextPath();
    path.rect(x, y, width, height);
    this.fill(path);
  }

  fillText(text: string, x: number, y: number) {
    const { font, fillStyle, textAlign, textBaseline } = this.state;
    // as wide as here also where the font is another
    const wide = this.measureText(text).width;
    this.parts.push(
      `<text x="${place(x)}" y="${place(y)}" fill="${fillStyle}" text-anchor="${ANCHORS[textAlign] ?? "start"}" ` +
        `dominant-baseline="${BASELINES[textBaseline] ?? "auto"}" textLength="${place(wide)}" lengthAdjust="spacingAndGlyphs" style="font: ${escaped(font)}"${this.where()}>${escaped(text)}</text>`,
    );
  }

  measureText(text: string): TextMetrics | { width: number } {
    ruler ??= document.createElement("canvas").getContext("2d");
    if (ruler === null) return { width: 8 * text.length };
    ruler.font = this.state.font;
    return ruler.measureText(text);
  }

  private where(): string {
    const { matrix, within, globalAlpha } = this.state;
    return (
      (String(matrix) === "1,0,0,1,0,0"
        ? ""
        : ` transform="matrix(${matrix.map((each) => coordinate(each, 4)).join(" ")})"`) +
      (within === "" ? "" : ` clip-path="url(#${within})"`) +
      (globalAlpha === 1 ? "" : ` opacity="${globalAlpha}"`)
    );
  }
}

let ruler: CanvasRenderingContext2D | null = null;

export function escaped(text: string): string {
  return text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll('"', "&quot;");
}
