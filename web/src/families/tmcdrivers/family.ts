import { IconBolt } from "@tabler/icons-react";
import { later } from "../../lib/later";
import { type Family, page } from "../family";

/** Drivers that are stepped from outside, or turn at a velocity of their own. */
export const tmcdrivers: Family = {
  pages: [
    {
      ...page(42, "/driver-current", "Current and chopper", "Current", IconBolt, { needs: ["current.scale"] }),
      load: () => import("./current/CurrentPage"),
    },
  ],
  Controls: later(() => import("./Controls").then((part) => part.Controls)),
  /** VACTUAL counts fCLK / 2^24 (TMC2209 data sheet, 5.2). */
  top: { name: "VACTUAL", pps: (clockHz) => clockHz / 2 ** 24, kept: "velocity" },
  /** They count no position. */
  zero: () => [],
  events: [],
  /** MSCURACT: the lower field is the sine, which a TMC2240 calls otherwise than its sisters */
  phases: (model) => (model === "tmc2240" ? { sine: "CUR_B", cosine: "CUR_A" } : { sine: "CUR_A", cosine: "CUR_B" }),
};
