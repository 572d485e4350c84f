import { useEffect, useMemo, useState } from "react";
import { type AxisAddress, motion } from "../../api/motion";
import type { TelemetrySource } from "../../live/TelemetrySource";
import { STOP_EVENT } from "../../shell/stopEverything";
import { HeldRun, type Leg, type RunState } from "./HeldRun";

/** Of these the module tells when somebody wanted the motor to stop. */
const WANTED = ["stop_command", "target_reached", "unknown"];

/**
 * A held run of one axis; it ends with the page, with the page's stop, when another axis is chosen, and when the motor
 * runs into something.
 */
export function useHeldRun(at: AxisAddress, source: TelemetrySource) {
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
  useEffect(
    () =>
      source.onStop((stop) => {
        if (stop.axis === axis && !WANTED.includes(stop.reason)) run.stuck(stop.reason);
      }),
    [source, run, axis],
  );
  return {
    state,
    running: state.phase === "running",
    start: (legs: readonly Leg[]) => run.start(legs),
    abort: () => run.abort(),
  };
}
