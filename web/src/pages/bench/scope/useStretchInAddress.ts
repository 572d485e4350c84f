import { useEffect, useRef } from "react";
import { putIntoAddress, useAddress } from "../../../lib/address";
import { useFrame } from "../../../live/useFrame";
import { textOf, windowOf } from "../../recordings/useView";
import { type ScopeSettings, textsOf } from "./settings";
import type { Scope } from "./useScope";

/** So long a picture stands before the address has it: browsers let a page change it only so often [ms]. */
const SETTLED_MS = 300;

/**
 * The stretch of time of a scope that stands still, and its cursors, in the address: `t=3.2~4.9&c=3.31~4.02` in the
 * device's time. A page that is opened with them stands there as soon as it has samples of then.
 */
export function useStretchInAddress(
  scope: Scope,
  settings: ScopeSettings,
  cursors: boolean,
  setCursors: (on: boolean) => void,
): void {
  const { t, c } = useAddress("t", "c");
  const wanted = useRef(windowOf(t));
  const { paused, view, sources } = scope;
  useFrame(() => {
    const source = sources[0];
    const window = wanted.current;
    if (!window || !source || Number.isNaN(source.buffer.lastTime)) return;
    wanted.current = null;
    const [first = 0] = source.buffer.times();
    // of another run of the device, or longer ago than is kept: the scope goes on live
    if (window[1] < first || window[0] > source.buffer.lastTime) return;
    scope.pause(window);
    const places = windowOf(c);
    if (!places) return;
    view.setCursors({ a: places[0], b: places[1] });
    setCursors(true);
  });
  useEffect(() => {
    if (wanted.current) return;
    if (!paused) {
      const stale = windowOf(new URLSearchParams(location.search).get("t") ?? "") !== null;
      if (stale) putIntoAddress({ t: textsOf(settings).t, c: "" }, "replace");
      return;
    }
    const put = () => {
      const { a, b } = view.cursors();
      const stretch = cursors ? textOf([Math.min(a, b), Math.max(a, b)]) : "";
      putIntoAddress({ t: textOf(view.current()), c: stretch }, "replace");
    };
    const timer = setInterval(put, SETTLED_MS);
    return () => clearInterval(timer);
  }, [paused, view, cursors, settings]);
}
