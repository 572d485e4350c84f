import { useEffect, useMemo, useState } from "react";
import { type AxisAddress, motion } from "../../api/motion";
import { STOP_EVENT } from "../../shell/stopEverything";
import { HeldRun, type Leg, type RunState } from "./HeldRun";

/** A held run of one axis; it ends with the page, with the page's stop, and when another axis is chosen. */
export function useHeldRun(at: AxisAddress) {
  const [state, setState] = useState<RunState>({ phase: "idle" });
  const { device, axis } = at;
  const run = useMemo(
    () =>
      new HeldRun(
        {
          rotate: (velocity, hold_s) => motion.rotate({ device, axis }, { velocity, unit: "pps", hold_s }),
          keep: (hold_s) => motion.keepRotating({ device, axis }, { hold_s }),
          halt: () => motion.stop({ device, axis }, "ramp"),
        },
        setState,
      ),
    [device, axis],
  );
  useEffect(() => {
    const abort = () => run.abort();
    window.addEventListener("pagehide", abort);
    window.addEventListener(STOP_EVENT, abort);
    return () => {
      run.abort();
      window.removeEventListener("pagehide", abort);
      window.removeEventListener(STOP_EVENT, abort);
    };
  }, [run]);
  return {
    state,
    running: state.phase === "running",
    start: (legs: readonly Leg[]) => run.start(legs),
    abort: () => run.abort(),
  };
}
