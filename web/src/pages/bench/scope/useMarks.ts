import { useQuery } from "@tanstack/react-query";
import { useEffect, useRef } from "react";
import { api, type Schemas } from "../../../api/client";
import type { Device } from "../../../api/queries";
import type { TelemetrySource } from "../../../live/TelemetrySource";

interface Told {
  time_s: number;
  text: string;
  kind: string;
}

/** So often the audit log is asked for what was written [ms]. */
const LOOK_MS = 1500;
const ENTRIES_MAX = 100;
const TOLD_MAX = 200;

/** What happened at the device's own times, for marks: what was written to it, how its axis stopped, what it told. */
export function useMarks(device: Device | undefined, axis: number, source: TelemetrySource | undefined, on: boolean) {
  const marks = useRef<readonly Told[]>([]);
  const told = useRef<readonly Told[]>([]);
  const id = device?.id ?? "";
  const log = useQuery({
    queryKey: ["audit", "marks", id],
    queryFn: async ({ signal }) => {
      const query = { device: id, limit: ENTRIES_MAX };
      return (await api.GET("/api/v1/audit", { query, signal })) as unknown as Schemas["AuditPage"];
    },
    enabled: on && id !== "",
    refetchInterval: LOOK_MS,
  });
  useEffect(() => {
    told.current = [];
    if (!source || !on) return;
    const tell = (mark: Told) => {
      told.current = [...told.current, mark].slice(-TOLD_MAX);
      marks.current = [...marks.current, mark];
    };
    const ends = [
      source.on("stopped", (stop) => {
        if (stop.axis === axis) tell({ time_s: stop.time_s, text: stop.reason.replaceAll("_", " "), kind: "stopped" });
      }),
      source.on("event", (event) => {
        if (event.axis === axis) tell({ time_s: event.time_s, text: event.names.join(" "), kind: "event" });
      }),
    ];
    return () => {
      for (const end of ends) end();
    };
  }, [source, axis, on]);
  const entries = log.data?.entries;
  useEffect(() => {
    const originS = source?.link().timeOriginUnixS;
    const written = on && originS != null ? (entries ?? []).flatMap((entry) => markOf(entry, axis, originS)) : [];
    marks.current = on ? [...written.reverse(), ...told.current] : [];
  }, [entries, source, axis, on]);
  return marks;
}

function markOf(entry: Schemas["AuditEntry"], axis: number, originS: number): Told[] {
  if (entry.outcome.startsWith("refused") || (entry.axis !== null && entry.axis !== axis)) return [];
  const value = entry.new === null ? "" : ` ${entry.new}`;
  return [
    {
      time_s: Date.parse(entry.time) / 1000 - originS,
      text: `${entry.subject || entry.action}${value}`,
      kind: "write",
    },
  ];
}
