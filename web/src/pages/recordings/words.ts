import { fixed } from "../../lib/format";
import { dateTimeOf } from "../../lib/time";
import { isRunning, type Recording, titleOf } from "./api";

export type SortKey = "name" | "device" | "started_unix_s" | "channels" | "size_bytes" | "state";
export interface Sort {
  key: SortKey;
  down: boolean;
}

function sortValue(recording: Recording, key: SortKey): string | number {
  if (key === "name") return titleOf(recording).toLocaleLowerCase();
  if (key === "channels") return recording.channels.length;
  return recording[key] ?? "";
}

/** In the order asked for; running ones stand on top, whatever it is. */
export function order(recordings: readonly Recording[], { key, down }: Sort): Recording[] {
  const sign = down ? -1 : 1;
  return [...recordings].sort((one, other) => {
    const running = Number(isRunning(other)) - Number(isRunning(one));
    if (running !== 0) return running;
    const [left, right] = [sortValue(one, key), sortValue(other, key)];
    if (left === right) return one.id < other.id ? 1 : -1;
    return left < right ? -sign : sign;
  });
}

/** The day and the time, in the browser's zone: 21 Nov 18:45:09. */
export function whenText(unixS: number | null): string {
  if (unixS === null) return "–";
  return dateTimeOf(unixS * 1000);
}

export function stateText(recording: Recording): string {
  const { state, rows } = recording;
  if (state === "waiting") return "waits for its trigger";
  if (state === "recording") return rows === null ? "running" : `running, ${fixed(rows)} rows`;
  return state === "failed" ? "failed" : "kept";
}
