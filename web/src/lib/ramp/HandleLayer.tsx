import { type KeyboardEvent, type PointerEvent, type RefObject, useEffect, useRef } from "react";
import type uPlot from "uplot";
import type { PlotHandle } from "../../plots/types";
import { dragged, type Handle, stepped } from "./handles";
import classes from "./ramp.module.css";

export interface Reach {
  /** [pps, pps², pps³] */
  least: number;
  most: number;
  /** the register's grid */
  step: number;
}

interface Props<P extends string> {
  plot: RefObject<PlotHandle | null>;
  handles: readonly Handle<P>[];
  /** what one unit of the plot's y is [pps, pps², pps³] */
  factor: number;
  color: string;
  reach: (parameter: P) => Reach;
  /** the value with its unit, to be read out */
  text: (parameter: P, value: number) => string;
  onChange: (parameter: P, value: number) => void;
  onHold: (held: boolean) => void;
}

interface Drag<P> {
  parameter: P;
  sign: 1 | -1;
  from: number;
  startY: number;
  perPx: number;
}

/** The knobs on a plot: taken by mouse, finger or keys, each a slider of its own for those who do not see them. */
export function HandleLayer<P extends string>(props: Props<P>) {
  const { plot, handles, factor, color, reach, text, onChange, onHold } = props;
  const layer = useRef<HTMLDivElement>(null);
  const knobs = useRef(new Map<P, HTMLElement>());
  const hooked = useRef(new WeakSet<uPlot>());
  const drag = useRef<Drag<P> | null>(null);
  const pending = useRef<{ y: number; request: number } | null>(null);
  const latest = useRef({ handles, factor });
  latest.current = { handles, factor };

  // As with the bands of a plot: each uPlot is found and hooked once, and moves the knobs whenever it draws.
  useEffect(() => {
    const instance = plot.current?.uplot;
    if (!instance || !layer.current) return;
    const place = (current: uPlot) => {
      const box = layer.current?.getBoundingClientRect();
      if (!box || current.scales.y?.min == null || current.scales.x?.min == null) return;
      const over = current.over.getBoundingClientRect();
      for (const handle of latest.current.handles) {
        const knob = knobs.current.get(handle.parameter);
        if (!knob) continue;
        const x = current.valToPos(handle.timeS, "x");
        const y = current.valToPos((handle.sign * handle.value) / latest.current.factor, "y");
        const beside = x < -1 || x > over.width + 1;
        const inside = Math.max(0, Math.min(over.height, y));
        knob.dataset.off = beside ? "x" : y < -1 || y > over.height + 1 ? "y" : "";
        knob.dataset.side = x > over.width - 70 ? "left" : "right";
        knob.style.transform = `translate(${over.left - box.left + x}px, ${over.top - box.top + inside}px)`;
      }
    };
    if (!hooked.current.has(instance)) {
      hooked.current.add(instance);
      instance.hooks.draw = [...(instance.hooks.draw ?? []), place];
    }
    place(instance);
  });

  function onDown(event: PointerEvent<HTMLElement>, handle: Handle<P>) {
    const instance = plot.current?.uplot;
    if (!instance || event.button !== 0) return;
    const perPx = (instance.posToVal(0, "y") - instance.posToVal(100, "y")) / 100;
    // one that waits at the edge of the plot is taken from there
    const { min = 0, max = 0 } = instance.scales.y as { min?: number; max?: number };
    const edge = (handle.sign > 0 ? max : -min) * factor;
    drag.current = {
      parameter: handle.parameter,
      sign: handle.sign,
      from: Math.min(handle.value, Math.max(edge, 0)),
      startY: event.clientY,
      perPx: perPx * factor,
    };
    event.currentTarget.setPointerCapture(event.pointerId);
    event.currentTarget.focus({ preventScroll: true });
    event.preventDefault();
    event.stopPropagation();
    onHold(true);
  }

  function follow(clientY: number) {
    const held = drag.current;
    if (!held) return;
    const { least, most, step } = reach(held.parameter);
    const next = dragged(held.from, held.sign, held.startY - clientY, held.perPx, step);
    onChange(held.parameter, Math.min(most, Math.max(least, next)));
  }

  const latestFollow = useRef(follow);
  latestFollow.current = follow;

  // A mouse tells of many places a frame; one of them is seen.
  function onMove(event: PointerEvent<HTMLElement>) {
    if (!drag.current) return;
    if (pending.current) {
      pending.current.y = event.clientY;
      return;
    }
    const request = requestAnimationFrame(() => {
      const place = pending.current;
      pending.current = null;
      if (place) latestFollow.current(place.y);
    });
    pending.current = { y: event.clientY, request };
  }

  function onUp() {
    if (!drag.current) return;
    if (pending.current) {
      cancelAnimationFrame(pending.current.request);
      follow(pending.current.y);
      pending.current = null;
    }
    drag.current = null;
    onHold(false);
  }

  function onKey(event: KeyboardEvent<HTMLElement>, handle: Handle<P>) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const next = stepped(event.key, event.shiftKey, handle.value, handle.sign, reach(handle.parameter));
    if (next === null) return;
    event.preventDefault();
    event.stopPropagation();
    onChange(handle.parameter, next);
  }

  return (
    <div ref={layer} className="cover touchless">
      {handles.map((handle) => {
        const { least, most } = reach(handle.parameter);
        return (
          <div
            key={handle.parameter}
            ref={(knob) => {
              if (knob) knobs.current.set(handle.parameter, knob);
              else knobs.current.delete(handle.parameter);
            }}
            className={classes.knob}
            style={{ color }}
            data-idle={handle.idle || undefined}
            data-parameter={handle.parameter}
            role="slider"
            tabIndex={0}
            aria-label={`${handle.parameter.toUpperCase()}, ${handle.meaning}`}
            aria-orientation="vertical"
            aria-valuemin={least}
            aria-valuemax={most}
            aria-valuenow={handle.value}
            aria-valuetext={`${text(handle.parameter, handle.value)}${handle.idle ? ", without effect on this ramp" : ""}`}
            onPointerDown={(event) => onDown(event, handle)}
            onPointerMove={onMove}
            onPointerUp={onUp}
            onPointerCancel={onUp}
            onLostPointerCapture={onUp}
            onKeyDown={(event) => onKey(event, handle)}
          >
            <span className={classes.knobDot} aria-hidden />
            <span className={`${classes.knobName} ink text-12 bold tight nowrap`} aria-hidden>
              {handle.parameter.toUpperCase()}
            </span>
          </div>
        );
      })}
    </div>
  );
}
