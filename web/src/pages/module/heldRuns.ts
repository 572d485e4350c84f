import { type AxisAddress, motion } from "../../api/motion";
import { KINDS } from "../../lib/condition/kinds";
import { conditions, type Kind } from "../../live/conditions";
import { tellRuns } from "../../shell/runs";
import { STOP_EVENT } from "../../shell/stopEverything";
import { HeldRun, type Leg, type RunState } from "./HeldRun";
import { endText } from "./runText";

/** A run of one axis, and who looks at it. It belongs to the tab, not to the page that began it. */
export interface TabRun {
  at: AxisAddress;
  run: HeldRun;
  /** the page that it was begun on */
  page: string;
  start: (legs: readonly Leg[]) => void;
  subscribe: (listener: () => void) => () => void;
  /** why it is over, where nobody here ended it and nobody has seen that yet */
  untold: () => string | null;
  /** Its end was seen. */
  seen: () => void;
}

/** In these something has ended the motion, whatever page is looked at. */
const STUCK: readonly Kind[] = ["held", "stalled", "driver_fault", "cannot_move"];

const runs = new Map<string, TabRun>();
const tell = () => tellRuns([...runs.values()].filter((each) => each.run.running || each.untold() !== null));

/** The run of that axis: another page of this tab may be looked at meanwhile, a stop or a closed tab ends it. */
export function runOf({ device, axis }: AxisAddress): TabRun {
  const key = `${device}/${axis}`;
  const known = runs.get(key);
  if (known) return known;
  const listeners = new Set<() => void>();
  let isSeen = false;
  const run = new HeldRun(
    {
      rotate: (velocity, hold_s) => motion.rotate({ device, axis }, { velocity, unit: "pps", hold_s }),
      keep: (hold_s) => motion.keepRotating({ device, axis }, { hold_s }),
      halt: () => motion.stop({ device, axis }, "ramp"),
    },
    (_: RunState) => {
      isSeen = false;
      for (const listener of listeners) listener();
      tell();
    },
  );
  window.addEventListener("pagehide", () => run.abort());
  window.addEventListener(STOP_EVENT, () => run.abort());
  const made: TabRun = {
    at: { device, axis },
    run,
    page: "/",
    start: (legs) => {
      made.page = window.location.pathname;
      run.start(legs);
    },
    subscribe: (listener) => {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
    untold: () => (isSeen ? null : endText(run.state)),
    seen: () => {
      if (made.untold() === null) return;
      isSeen = true;
      tell();
    },
  };
  runs.set(key, made);
  endWhenStuck(made);
  return made;
}

function endWhenStuck({ at, run }: TabRun): void {
  let turned = false; // before it turns, it is as whatever was before has left it
  conditions.subscribe(() => {
    const { kind } = conditions.of(at.device, at.axis).condition;
    turned = run.running && (turned || kind === "moving");
    if (turned && STUCK.includes(kind)) run.stuck(KINDS[kind].word);
  });
}
