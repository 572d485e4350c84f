import { later } from "../../lib/later";
import type { Family } from "../family";

/** Modules of which the names of parameters are known: what TMCL means by a name on every module. */
export const listed: Family = {
  pages: [],
  Controls: later(() => import("./Controls").then((part) => part.Controls)),
  top: { name: "MaxVelocity" },
  /** Target speed 0 takes it to velocity mode, where no target is followed. */
  zero: () => [
    { name: "TargetVelocity", value: 0 },
    { name: "ActualPosition", value: 0 },
  ],
  events: [],
};
