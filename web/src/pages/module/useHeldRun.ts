import { useEffect, useMemo, useSyncExternalStore } from "react";
import type { AxisAddress } from "../../api/motion";
import type { TelemetrySource } from "../../live/TelemetrySource";
import { runOf } from "./heldRuns";

/** Of these the module tells when the motor was told to stop. */
const WANTED = ["stop_command", "target_reached", "unknown"];

/**
 * A held run of one axis. It goes on while another page is looked at; it ends with the tab, with the page's stop, and
 * when the motor runs into something.
 */
export function useHeldRun(at: AxisAddress, source: TelemetrySource) {
  const { device, axis } = at;
  const { run, start, subscribe, seen } = useMemo(() => runOf({ device, axis }), [device, axis]);
  const state = useSyncExternalStore(subscribe, () => run.state);
  useEffect(() => {
    if (state.phase !== "running") seen(); // told here
  }, [state, seen]);
  useEffect(
    () =>
      source.on("stopped", (stop) => {
        if (stop.axis === axis && !WANTED.includes(stop.reason)) run.stuck(stop.reason);
      }),
    [source, run, axis],
  );
  return {
    state,
    running: state.phase === "running",
    start,
    abort: () => run.abort(),
  };
}
