import { useQuery } from "@tanstack/react-query";
import { useEffect, useRef } from "react";
import { api, type Schemas } from "../../../../api/client";
import type { Scope } from "../useScope";

/** A mark of the scope: when something happened, in words. */
export interface Told {
  time_s: number;
  text: string;
  kind: string;
}

/** So often the audit log is asked for what was written [ms]. */
const LOOK_MS = 1500;
const ENTRIES_MAX = 100;
const TOLD_MAX = 200;

interface Props {
  device: string;
  axis: number;
  scope: Scope;
}

/** What happened at the device's own times, for marks: what was written to it, how its axis stopped, what it told. */
export function ToldMarks({ device, axis, scope: { sources, told: marks } }: Props) {
  const source = sources[0];
  const told = useRef<readonly Told[]>([]);
  const log = useQuery({
    queryKey: ["audit", "marks", device],
    queryFn: async ({ signal }) => {
      const query = { device, limit: ENTRIES_MAX };
      return (await api.GET("/api/v1/audit", { query, signal })) as unknown as Schemas["AuditPage"];
    },
    enabled: device !== "",
    refetchInterval: LOOK_MS,
  });
  useEffect(() => {
    told.current = [];
    if (!source) return;
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
      marks.current = [];
    };
  }, [source, axis, marks]);
  const entries = log.data?.entries;
  useEffect(() => {
    const originS = source?.link().timeOriginUnixS;
    const written = originS == null ? [] : (entries ?? []).flatMap((entry) => markOf(entry, axis, originS));
    marks.current = [...written.reverse(), ...told.current];
  }, [entries, source, axis, marks]);
  return null;
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
