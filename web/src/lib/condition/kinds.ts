import {
  IconAlertOctagon,
  IconArrowsRightLeft,
  IconBan,
  IconBolt,
  IconCircle,
  IconHelpCircle,
  IconLockPause,
  IconPlugConnectedX,
  IconRulerMeasure,
  IconStairs,
  IconTargetArrow,
} from "@tabler/icons-react";
import type { ComponentType } from "react";
import type { Condition, Kind } from "../../live/conditions";
import { fixed } from "../format";

interface Look {
  word: string;
  /** the shade, next to the icon and the word: never the only sign */
  tone: "good" | "busy" | "calm" | "warn" | "bad" | "none";
  Icon: ComponentType<{ size?: number; stroke?: number; "aria-hidden"?: boolean }>;
}

/** What each kind of condition looks like, everywhere. */
export const KINDS: Record<Kind, Look> = {
  not_connected: { word: "Not connected", tone: "none", Icon: IconPlugConnectedX },
  unknown: { word: "Unknown", tone: "none", Icon: IconHelpCircle },
  cannot_move: { word: "Cannot move", tone: "warn", Icon: IconBan },
  ready: { word: "Ready", tone: "calm", Icon: IconCircle },
  moving: { word: "Moving", tone: "busy", Icon: IconArrowsRightLeft },
  on_target: { word: "On target", tone: "good", Icon: IconTargetArrow },
  held: { word: "Held", tone: "warn", Icon: IconLockPause },
  stalled: { word: "Stalled", tone: "bad", Icon: IconAlertOctagon },
  lost_steps: { word: "Lost steps", tone: "bad", Icon: IconStairs },
  following_error: { word: "Following error", tone: "bad", Icon: IconRulerMeasure },
  driver_fault: { word: "Driver fault", tone: "bad", Icon: IconBolt },
};

/** Kinds that are said aloud when an axis comes to be so. */
export const isBad = (kind: Kind): boolean => ["bad", "warn", "none"].includes(KINDS[kind].tone);

/** A sentence of the server as one that begins a line. */
export const sentence = (text: string): string => (text === "" ? "" : text[0]?.toUpperCase() + text.slice(1));

/** For how long it has been so: by the device's own clock, `nowS` being the newest reading's time. */
export function sinceWords({ since_s: since }: Condition, nowS: number | undefined): string {
  if (since === null) return "";
  if (nowS === undefined || nowS < since) return `since t = ${fixed(since, 1, "s")}`;
  const s = Math.floor(nowS - since);
  if (s < 60) return `for ${s} s`;
  return s < 3600
    ? `for ${Math.floor(s / 60)} min ${s % 60} s`
    : `for ${Math.floor(s / 3600)} h ${Math.floor((s % 3600) / 60)} min`;
}

export function referencedWords(referenced: boolean | null): string {
  if (referenced === null) return "Reference not known";
  return referenced ? "Referenced" : "Not referenced";
}
