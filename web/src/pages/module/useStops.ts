import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { api, type Schemas } from "../../api/client";
import type { AxisAddress } from "../../api/motion";
import type { TelemetrySource } from "../../live/TelemetrySource";
import type { Mark } from "../../plots/types";

export type MotionEnd = Schemas["MotionEnd"];
export type StopReason = MotionEnd["reason"];

interface Words {
  text: string;
  /** at a mark in a plot */
  short: string;
  /** it was a fault, not a command */
  fault: boolean;
}

export const REASONS: Record<StopReason, Words> = {
  target_reached: { text: "Target reached", short: "target", fault: false },
  stop_command: { text: "Stop command", short: "stop", fault: false },
  left_switch: { text: "Left switch", short: "left", fault: false },
  right_switch: { text: "Right switch", short: "right", fault: false },
  stall: { text: "Stall", short: "stall", fault: true },
  deviation: { text: "Deviation too large", short: "deviation", fault: true },
  driver_error: { text: "Driver error", short: "driver", fault: true },
  lost_link: { text: "Link lost", short: "link", fault: true },
  unknown: { text: "Cause unknown", short: "?", fault: false },
};

const FAULT = { light: "#d02828", dark: "#ff6b6b" };
const PLAIN = { light: "#6b7480", dark: "#7a828c" };

/** Stops as marks in a plot over time. */
export function stopMarks(stops: readonly MotionEnd[], scheme: "light" | "dark"): Mark[] {
  return stops.map(({ time_s, reason }) => ({
    id: `stop${time_s}`,
    x: time_s,
    color: (REASONS[reason].fault ? FAULT : PLAIN)[scheme],
    label: REASONS[reason].short,
    fixed: true,
  }));
}

/** What ended the motions of an axis, newest first: asked for now and then, and at once when the socket tells of one. */
export function useStops(at: AxisAddress, source: TelemetrySource, enabled: boolean) {
  const queries = useQueryClient();
  const { device, axis } = at;
  const stops = useQuery({
    queryKey: ["stops", device, axis],
    queryFn: () => api.GET("/api/v1/devices/{device}/axes/{axis}/stops", { path: { device, axis } }),
    enabled,
    refetchInterval: 5000,
  });
  useEffect(
    () =>
      source.on("stopped", (stop) => {
        if (stop.axis === axis) void queries.invalidateQueries({ queryKey: ["stops", device, axis] });
      }),
    [source, queries, device, axis],
  );
  return stops;
}
