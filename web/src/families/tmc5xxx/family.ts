import { IconBolt, IconTimeline } from "@tabler/icons-react";
import { can } from "../../api/queries";
import { later } from "../../lib/later";
import { type Family, page } from "../family";

const RAMP_MODE = 0;
const HOLD_MODE = 3;

export const tmc5xxx: Family = {
  pages: [
    {
      ...page(22, "/sixpoint", "SixPoint ramp", "SixPoint", IconTimeline, {
        needs: ["ramp.sixpoint"],
        alone: true,
        topic: "ramp",
      }),
      load: () => import("./sixpoint/SixPointPage"),
    },
    {
      ...page(40, "/currents", "Currents", "Currents", IconBolt, { needs: ["chopper"], alone: true }),
      load: () => import("./currents/CurrentsPage"),
    },
  ],
  Controls: later(() => import("./Controls").then((part) => part.Controls)),
  /** VMAX counts fCLK / 2^24 (TMC5160A data sheet, 12.1). */
  top: { name: "VMAX", pps: (clockHz) => clockHz / 2 ** 24, kept: "ramp" },
  /** In hold mode it follows no target. What its encoder counts goes along, where it has one. */
  zero: (device) => [
    { name: "RAMPMODE", value: HOLD_MODE },
    { name: "XACTUAL", value: 0 },
    { name: "XTARGET", value: 0 },
    ...(can(device, "encoder") ? [{ name: "X_ENC", value: 0 }] : []),
    { name: "RAMPMODE", value: RAMP_MODE },
  ],
  events: ["RAMP_STAT", "GSTAT"],
  /** MSCURACT of all five */
  phases: { sine: "CUR_B", cosine: "CUR_A" },
};
