import { useEffect, useRef } from "react";
import { putIntoAddress } from "../../../../lib/address";
import { useFrame } from "../../../../live/useFrame";
import { textOf, windowOf } from "../../../recordings/useView";
import { isStretch, type ScopeSettings, textsOf } from "../settings";
import type { Scope } from "../useScope";

/** So long a picture stands before the address has it: browsers let a page change it only so often [ms]. */
const SETTLED_MS = 300;

interface Props {
  scope: Scope;
  settings: ScopeSettings;
  cursors: boolean;
  setCursors: (on: boolean) => void;
}

const said = (key: "t" | "c") => new URLSearchParams(location.search).get(key) ?? "";

/**
 * The stretch of time of a scope that stands still, and its cursors, in the address: `t=3.2~4.9&c=3.31~4.02` in the
 * device's time. A page that is opened with them stands there as soon as it has samples of then.
 */
export function StretchInAddress({ scope, settings, cursors, setCursors }: Props) {
  const { paused, view, sources } = scope;
  const wanted = useRef(paused ? null : windowOf(said("t")));
  const goOn = () => {
    if (isStretch(said("t"))) putIntoAddress({ t: textsOf(settings).t, c: "" }, "replace");
  };
  useFrame(() => {
    const source = sources[0];
    const window = wanted.current;
    if (!window || !source || Number.isNaN(source.buffer.lastTime)) return;
    wanted.current = null;
    const [first = 0] = source.buffer.times();
    // of another run of the device, or longer ago than is kept: the scope goes on live
    if (window[1] < first || window[0] > source.buffer.lastTime) {
      goOn();
      return;
    }
    const places = windowOf(said("c"));
    scope.pause(window);
    if (!places) return;
    view.setCursors({ a: places[0], b: places[1] });
    setCursors(true);
  });
  // biome-ignore lint/correctness/useExhaustiveDependencies: settings change only what it goes on with
  useEffect(() => {
    if (wanted.current) return;
    if (!paused) {
      goOn();
      return;
    }
    const put = () => {
      const { a, b } = view.cursors();
      const stretch = cursors ? textOf([Math.min(a, b), Math.max(a, b)]) : "";
      putIntoAddress({ t: textOf(view.current()), c: stretch }, "replace");
    };
    const timer = setInterval(put, SETTLED_MS);
    return () => clearInterval(timer);
  }, [paused, view, cursors]);
  return null;
}
