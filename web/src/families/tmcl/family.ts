import { IconAdjustments } from "@tabler/icons-react";
import { later } from "../../lib/later";
import { type Family, page } from "../family";

export const tmcl: Family = {
  pages: [
    {
      ...page(11, "/parameters", "Parameters", "Params", IconAdjustments, {
        needs: ["parameters"],
        topic: "settings",
      }),
      load: () => import("./parameters/ParametersPage"),
    },
  ],
  Controls: later(() => import("./Controls").then((part) => part.Controls)),
  top: { name: "maximum_positioning_speed" },
  /**
   * Target speed 0 takes it to velocity mode, where no target is followed. The encoder counts along, so it is set too:
   * else the difference would be a deviation, and could stop the motor.
   */
  zero: () => [
    { name: "target_speed", value: 0 },
    { name: "actual_position", value: 0 },
    { name: "encoder_position", value: 0 },
  ],
  events: [],
};
