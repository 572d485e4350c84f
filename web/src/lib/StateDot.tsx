import type { Device } from "../api/queries";
import classes from "./StateDot.module.css";

const WORDS: Record<Device["state"], string> = {
  connected: "connected",
  connecting: "connecting",
  disconnected: "disconnected",
  failed: "failed",
};

/** The state of a device's link as a dot: filled, hollow, crossed; the shape says it as well as the colour. */
export function StateDot({ state }: { state: Device["state"] }) {
  return <span className={classes.dot} data-state={state} role="img" aria-label={WORDS[state]} title={WORDS[state]} />;
}
