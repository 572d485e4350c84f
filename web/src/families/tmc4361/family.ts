import {
  IconArrowsJoin,
  IconBinary,
  IconBolt,
  IconFilter,
  IconPlayerPlay,
  IconTargetArrow,
  IconVectorSpline,
} from "@tabler/icons-react";
import { api } from "../../api/client";
import { later } from "../../lib/later";
import { type Family, page } from "../family";

export const tmc4361: Family = {
  pages: [
    {
      ...page(21, "/sramp", "S-ramp", "S-ramp", IconVectorSpline, { needs: ["ramp.s"], alone: true, topic: "ramp" }),
      load: () => import("./sramp/SRampPage"),
    },
    {
      ...page(30, "/closed-loop", "Closed loop", "Loop", IconTargetArrow, { needs: ["closed_loop"], topic: "encoder" }),
      load: () => import("./closedloop/ClosedLoopPage"),
    },
    {
      ...page(31, "/filters", "Input filters", "Filters", IconFilter, { needs: ["input_filters"], alone: true }),
      load: () => import("./filters/FiltersPage"),
    },
    {
      ...page(32, "/serial-encoder", "Serial encoder", "SSI/SPI", IconBinary, { needs: ["serial_encoder"] }),
      load: () => import("./serial/SerialEncoderPage"),
    },
    {
      ...page(33, "/driver-sync", "Driver sync", "dcStep", IconArrowsJoin, { needs: ["driver_sync"] }),
      load: () => import("./sync/DriverSyncPage"),
    },
    {
      ...page(34, "/start", "Start and steps", "Start", IconPlayerPlay, { needs: ["start_pin"] }),
      load: () => import("./start/StartPage"),
    },
    {
      ...page(41, "/drive-currents", "Drive currents", "Currents", IconBolt, { needs: ["current.ramp"] }),
      load: () => import("./output/OutputPage"),
    },
  ],
  Controls: later(() => import("./Controls").then((part) => part.Controls)),
  /** VMAX counts 1/256 pps whatever else is set (DS-TMC4361 8). */
  top: { name: "VMAX", pps: () => 1 / 256 },
  /**
   * It follows its target while it positions, and turns at VMAX while it does not: with VMAX 0 it does neither. The
   * encoder counts along, but not in a closed loop: there the motor is commutated by what it says.
   */
  zero: async ({ id: device }) => {
    const read = (name: string) => api.GET("/api/v1/devices/{device}/registers/{name}", { path: { device, name } });
    const [vmax, encoder] = await Promise.all([read("VMAX"), read("ENC_IN_CONF")]);
    const open = (encoder.fields.regulation_modus ?? 0) === 0;
    return [
      { name: "VMAX", value: 0 },
      { name: "XACTUAL", value: 0 },
      { name: "XTARGET", value: 0 },
      ...(open ? [{ name: "ENC_POS", value: 0 }] : []),
      { name: "VMAX", value: vmax.value },
    ];
  },
  events: ["EVENTS"],
};
