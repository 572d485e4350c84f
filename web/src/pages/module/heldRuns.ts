import { type AxisAddress, motion } from "../../api/motion";
import { STOP_EVENT } from "../../shell/stopEverything";
import { HeldRun, type RunState } from "./HeldRun";

/** A run of one axis, and who looks at it. It belongs to the tab, not to the page that began it. */
export interface TabRun {
  run: HeldRun;
  subscribe: (listener: () => void) => () => void;
}

const runs = new Map<string, TabRun>();

/** The run of that axis: another page of this tab may be looked at meanwhile, a stop or a closed tab ends it. */
export function runOf({ device, axis }: AxisAddress): TabRun {
  const key = `${device}/${axis}`;
  const known = runs.get(key);
  if (known) return known;
  const listeners = new Set<() => void>();
  const run = new HeldRun(
    {
      rotate: (velocity, hold_s) => motion.rotate({ device, axis }, { velocity, unit: "pps", hold_s }),
      keep: (hold_s) => motion.keepRotating({ device, axis }, { hold_s }),
      halt: () => motion.stop({ device, axis }, "ramp"),
    },
    (_: RunState) => {
      for (const listener of listeners) listener();
    },
  );
  window.addEventListener("pagehide", () => run.abort());
  window.addEventListener(STOP_EVENT, () => run.abort());
  const made: TabRun = {
    run,
    subscribe: (listener) => {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
  };
  runs.set(key, made);
  return made;
}
