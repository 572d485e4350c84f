import type { Schemas } from "../../api/client";
import { coordinate } from "../../lib/format";

export type Frame = Schemas["FrameEntry"];
export type Show = "all" | "commands" | "samples";

export interface Filter {
  text: string;
  show: Show;
  errorsOnly: boolean;
}

/** Samples come by the thousand: so many are kept of them, and so many of all others and of failures. */
const SAMPLES_KEPT = 2000;
const OTHERS_KEPT = 3000;

const isSample = (frame: Frame) => frame.priority === "sample" && frame.error === null;

/** The log with what came: in order, the oldest samples dropped before anything that people did. */
export function append(frames: readonly Frame[], came: readonly Frame[]): Frame[] {
  const last = frames.at(-1)?.seq ?? -1;
  const joined = [...frames, ...came.filter((frame) => frame.seq > last)];
  let samples = joined.filter(isSample).length - SAMPLES_KEPT;
  let others = joined.length - joined.filter(isSample).length - OTHERS_KEPT;
  if (samples <= 0 && others <= 0) return joined;
  return joined.filter((frame) => {
    if (isSample(frame)) {
      samples -= 1;
      return samples < 0;
    }
    others -= 1;
    return others < 0;
  });
}

export function passes(frame: Frame, filter: Filter): boolean {
  if (filter.errorsOnly && !isBad(frame)) return false;
  if (filter.show === "commands" && frame.priority === "sample") return false;
  if (filter.show === "samples" && frame.priority !== "sample") return false;
  const words = filter.text.toLowerCase().split(/\s+/).filter(Boolean);
  if (words.length === 0) return true;
  const text = `${frame.text} ${frame.priority} ${frame.error ?? ""}`.toLowerCase();
  return words.every((word) => text.includes(word) || hasBytes(frame.tx, word) || hasBytes(frame.rx ?? "", word));
}

/** Whether the digits stand there as whole bytes: half of one and half of the next is nothing that anybody looks for. */
function hasBytes(hex: string, digits: string): boolean {
  for (let at = hex.indexOf(digits); at >= 0; at = hex.indexOf(digits, at + 1)) if (at % 2 === 0) return true;
  return false;
}

/** No good answer, or an answer that says no. */
export function isBad(frame: Frame): boolean {
  return frame.error !== null || / -> [a-z].*\(\d+\)$/.test(frame.text);
}

export function clock(unixS: number): string {
  const time = new Date(unixS * 1000);
  const two = (number: number) => String(number).padStart(2, "0");
  const fraction = String(Math.floor((unixS % 1) * 1000)).padStart(3, "0");
  return `${two(time.getHours())}:${two(time.getMinutes())}:${two(time.getSeconds())}.${fraction}`;
}

export function spaced(hex: string | null): string {
  return (hex ?? "").replace(/(..)(?=.)/g, "$1 ");
}

/** For a mail or an issue: one frame a line. */
export function asText(frames: readonly Frame[]): string {
  return frames
    .map((frame) =>
      [
        clock(frame.time_unix_s),
        frame.priority.padEnd(7),
        `> ${spaced(frame.tx)}`,
        `< ${spaced(frame.rx) || "nothing"}`,
        `${coordinate(frame.took_ms)} ms`,
        frame.text,
        frame.error ?? "",
      ]
        .filter(Boolean)
        .join("  "),
    )
    .join("\n");
}

/** For a table: RFC 4180, times in Unix seconds. */
export function asCsv(frames: readonly Frame[]): string {
  const cell = (value: unknown) => {
    const text = value === null ? "" : String(value);
    return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  const head = "seq,time_unix_s,priority,tx,rx,took_ms,text,error";
  return [
    head,
    ...frames.map((frame) =>
      [frame.seq, frame.time_unix_s, frame.priority, frame.tx, frame.rx, frame.took_ms, frame.text, frame.error]
        .map(cell)
        .join(","),
    ),
  ].join("\n");
}
