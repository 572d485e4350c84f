import { IconBinaryTree, IconChartLine, IconTimeline } from "@tabler/icons-react";
import { can } from "../../api/queries";
import { later } from "../../lib/later";
import { type Family, page } from "../family";

const RAMP_MODE = 0;
const HOLD_MODE = 3;

export const tmc428: Family = {
  pages: [
    {
      ...page(20, "/ramps", "Ramps", "Ramps", IconChartLine, { needs: ["ramp.pmul"], alone: true, topic: "ramp" }),
      load: () => import("./ramps/RampsPage"),
    },
    {
      ...page(25, "/velocity", "Velocity profile", "v(t)", IconTimeline, { needs: ["ramp.pmul"] }),
      load: () => import("./velocity/VelocityPage"),
    },
    {
      ...page(60, "/chain", "Driver chain", "Chain", IconBinaryTree, {
        needs: ["driver_chain", "step_dir"],
        alone: true,
      }),
      load: () => import("./chain/ChainPage"),
    },
  ],
  Controls: later(() => import("./Controls").then((part) => part.Controls)),
  top: { name: "V_MAX" },
  /**
   * In RAMP_MODE the motor would run after the difference between the two registers the moment one of them is written:
   * so it is taken out of that mode for the time of both writes. Each data sheet has its own name for the field.
   */
  zero: (device) => {
    const mode = can(device, "step_dir") ? "RAMP_MODE" : "rm";
    return [
      { name: mode, value: HOLD_MODE },
      { name: "X_ACTUAL", value: 0 },
      { name: "X_TARGET", value: 0 },
      { name: mode, value: RAMP_MODE },
    ];
  },
  /** as each data sheet spells them; of which a chip has some */
  events: ["interrupt_mask_interrupt_flags", "INTERRUPT_MASK_INTERRUPT_FLAGS", "pos_comp_int_429", "POS_COMP_INT_4210"],
  eventNames: { I: "POS_COMP" },
  eventsNeed: "whose mask bit is set",
};
