import type uPlot from "uplot";
import type { Level, Mark, WindowChange } from "./types";

/** What the gestures need of the plot around them. */
export interface InteractionHost {
  /** the x range of all that could be seen */
  bounds: () => readonly [number, number];
  /** bounds that no gesture leaves, if any */
  limit: () => readonly [number, number] | null;
  changeWindow: (change: WindowChange) => void;
  marks: () => readonly Mark[];
  moveMark: (id: string, x: number) => void;
  levels: () => readonly Level[];
  moveLevel: (id: string, y: number) => void;
}

const GRAB_PX = 7;

function xWindow(plot: uPlot): [number, number] {
  const { min, max } = plot.scales.x ?? {};
  return [min ?? 0, max ?? 1];
}

/** Zoom by `factor` (below 1 is closer) around `around`, kept within the limit and above the resolution of a double. */
export function zoomed(
  [min, max]: readonly [number, number],
  around: number,
  factor: number,
  limit: readonly [number, number] | null,
): { min: number; max: number } {
  const smallest = Math.max(Math.abs(around) * 1e-12, 1e-9);
  const size = Math.max((max - min) * factor, smallest);
  const share = max > min ? (around - min) / (max - min) : 0.5;
  return kept({ min: around - size * share, max: around + size * (1 - share) }, limit);
}

export function kept(
  wanted: { min: number; max: number },
  limit: readonly [number, number] | null,
): { min: number; max: number } {
  if (limit === null) return wanted;
  const size = Math.min(wanted.max - wanted.min, limit[1] - limit[0]);
  const min = Math.min(Math.max(wanted.min, limit[0]), limit[1] - size);
  return { min, max: min + size };
}

/**
 * Wheel zooms around the pointer (with Shift, or a sideways wheel: pans); Shift or the middle button drags; a finger
 * drags, two pinch; a double click or tap shows all. A plain drag selects what to zoom into: uPlot's own.
 */
export function pointerPlugin(host: InteractionHost): uPlot.Plugin {
  let stopListening: () => void = () => undefined;

  function ready(plot: uPlot) {
    const over = plot.over;
    const fingers = new Map<number, number>();
    let pan: { x: number; window: [number, number] } | null = null;
    let mark: string | null = null;
    let level: Level | null = null;
    let pinch: { size: number; centre: number; window: [number, number] } | null = null;

    const left = (event: { clientX: number }) => event.clientX - over.getBoundingClientRect().left;
    const perPixel = () => {
      const [min, max] = xWindow(plot);
      return (max - min) / Math.max(1, over.clientWidth);
    };
    const markAt = (px: number) =>
      host.marks().find((entry) => !entry.fixed && Math.abs(plot.valToPos(entry.x, "x") - px) <= GRAB_PX);

    const top = (event: { clientY: number }) => event.clientY - over.getBoundingClientRect().top;
    const levelAt = (py: number) =>
      host
        .levels()
        .find((entry) => !entry.fixed && Math.abs(plot.valToPos(entry.y, entry.scale ?? "y") - py) <= GRAB_PX);

    function onWheel(event: WheelEvent) {
      event.preventDefault();
      const window = xWindow(plot);
      const sideways = event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY);
      const unit = event.deltaMode === 1 ? 16 : 1;
      if (sideways) {
        const delta = (event.deltaX || event.deltaY) * unit * perPixel();
        host.changeWindow(kept({ min: window[0] + delta, max: window[1] + delta }, host.limit()));
      } else {
        const factor = Math.exp(Math.max(-1, Math.min(1, event.deltaY * unit * 0.002)));
        host.changeWindow(zoomed(window, plot.posToVal(left(event), "x"), factor, host.limit()));
      }
    }

    function startPinch() {
      const [first = 0, second = 0] = [...fingers.values()];
      pinch = {
        size: Math.max(8, Math.abs(first - second)),
        centre: plot.posToVal((first + second) / 2, "x"),
        window: xWindow(plot),
      };
      pan = null;
    }

    function onDown(event: PointerEvent) {
      const px = left(event);
      const grabbed = event.button === 0 ? markAt(px) : undefined;
      const held = event.button === 0 && !grabbed ? levelAt(top(event)) : undefined;
      const touch = event.pointerType === "touch";
      if (!grabbed && !held && !touch && event.button !== 1 && !(event.button === 0 && event.shiftKey)) return;
      over.setPointerCapture(event.pointerId);
      if (grabbed) mark = grabbed.id;
      else if (held) level = held;
      else if (touch) {
        fingers.set(event.pointerId, px);
        if (fingers.size === 2) startPinch();
        else pan = { x: px, window: xWindow(plot) };
      } else pan = { x: px, window: xWindow(plot) };
      event.preventDefault(); // no mousedown follows, so that uPlot does not start a selection of its own
    }

    function onMove(event: PointerEvent) {
      const px = left(event);
      if (fingers.has(event.pointerId)) fingers.set(event.pointerId, px);
      if (mark !== null) host.moveMark(mark, plot.posToVal(Math.max(0, Math.min(over.clientWidth, px)), "x"));
      else if (level !== null) {
        const py = Math.max(0, Math.min(over.clientHeight, top(event)));
        host.moveLevel(level.id, plot.posToVal(py, level.scale ?? "y"));
      } else if (pinch !== null && fingers.size === 2) {
        const [first = 0, second = 0] = [...fingers.values()];
        const factor = pinch.size / Math.max(8, Math.abs(first - second));
        host.changeWindow(zoomed(pinch.window, pinch.centre, factor, host.limit()));
      } else if (pan !== null) {
        const size = pan.window[1] - pan.window[0];
        const delta = ((px - pan.x) / Math.max(1, over.clientWidth)) * size;
        host.changeWindow(kept({ min: pan.window[0] - delta, max: pan.window[1] - delta }, host.limit()));
      } else over.style.cursor = markAt(px) ? "ew-resize" : levelAt(top(event)) ? "ns-resize" : "";
    }

    function onUp(event: PointerEvent) {
      fingers.delete(event.pointerId);
      mark = null;
      level = null;
      pinch = null;
      pan = null;
    }

    function onDouble(event: MouseEvent) {
      event.preventDefault();
      host.changeWindow("reset");
    }

    over.style.touchAction = "pan-y"; // the page still scrolls under a finger that moves up or down
    const listeners: [string, EventListener, AddEventListenerOptions?][] = [
      ["wheel", onWheel as EventListener, { passive: false }],
      ["pointerdown", onDown as EventListener],
      ["pointermove", onMove as EventListener],
      ["pointerup", onUp as EventListener],
      ["pointercancel", onUp as EventListener],
      ["lostpointercapture", onUp as EventListener],
      ["dblclick", onDouble as EventListener],
    ];
    for (const [name, listener, options] of listeners) over.addEventListener(name, listener, options);
    stopListening = () => {
      for (const [name, listener, options] of listeners) over.removeEventListener(name, listener, options);
    };
  }

  return { hooks: { ready, destroy: () => stopListening() } };
}

/** Arrow keys move the cursor (Shift: ten times), + and - zoom around it, Page keys pan, 0 shows all. True: handled. */
export function handleKey(plot: uPlot, key: string, shift: boolean, host: InteractionHost): boolean {
  const [min, max] = xWindow(plot);
  const width = plot.over.clientWidth;
  const { left = -10 } = plot.cursor;
  const here = left >= 0 ? plot.posToVal(left, "x") : (min + max) / 2;
  const place = (px: number) =>
    plot.setCursor({ left: Math.max(0, Math.min(width - 1, px)), top: plot.over.clientHeight / 2 });
  const move = (px: number) => place((left >= 0 ? left : width / 2) + px * (shift ? 10 : 1));
  const pan = (share: number) => {
    const delta = (max - min) * share;
    host.changeWindow(kept({ min: min + delta, max: max + delta }, host.limit()));
  };
  switch (key) {
    case "ArrowLeft":
      move(-2);
      return true;
    case "ArrowRight":
      move(2);
      return true;
    case "Home":
      place(0);
      return true;
    case "End":
      place(width - 1);
      return true;
    case "PageUp":
      pan(-0.5);
      return true;
    case "PageDown":
      pan(0.5);
      return true;
    case "+":
    case "=":
      host.changeWindow(zoomed([min, max], here, 0.7, host.limit()));
      return true;
    case "-":
    case "_":
      host.changeWindow(zoomed([min, max], here, 1 / 0.7, host.limit()));
      return true;
    case "0":
      host.changeWindow("reset");
      return true;
    default:
      return false;
  }
}
