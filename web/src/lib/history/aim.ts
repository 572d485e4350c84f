import type { Schemas } from "../../api/client";
import { record } from "./history";

/** What a device shall be put back to, and how that is called. */
export interface Aim {
  device: string;
  order: Pick<Schemas["UndoOrder"], "since" | "before" | "without">;
  title: string;
}

/** Where the history opens: at its lists, at a preview, or at that of the latest change of a device. */
export type Opening = Aim | { latest: string } | null;

const OPEN = "stepscope:history";

/** Opens the history from elsewhere. */
export function openHistory(at: Opening = null): void {
  window.dispatchEvent(new CustomEvent(OPEN, { detail: at }));
}

export function onOpenHistory(listen: (at: Opening) => void): () => void {
  const heard = (event: Event) => listen((event as CustomEvent<Opening>).detail);
  window.addEventListener(OPEN, heard);
  return () => window.removeEventListener(OPEN, heard);
}

/** Calls that write registers of a device. */
const WRITES =
  /^(?:PUT|POST) \/api\/v1\/devices\/([^/]+)\/(?:registers(?:\/[^/]+)?|profile|undo|start-up|microstep-table|driver-chain)$/;

/** Enters a call that has written into a device: taken back, it opens a preview of what that would write. */
export function enterWrite(method: string, address: string): void {
  const id = WRITES.exec(`${method} ${new URL(address).pathname}`)?.[1];
  if (id === undefined) return;
  const device = decodeURIComponent(id);
  const of = `written ${device}`;
  const asking = () => openHistory({ latest: device });
  record({ label: `Written into ${device}`, of, merge: of, asks: true, undo: asking, redo: asking });
}

/** A device as it was so many minutes ago. */
export function minutesAgo(device: string, minutes: number, now = Date.now()): Aim {
  const since = new Date(now - minutes * 60_000).toISOString();
  return { device, order: { since }, title: `As it was ${minutes === 60 ? "an hour" : `${minutes} minutes`} ago` };
}

/** Without one change. */
export const withoutChange = (device: string, entry: number, what: string): Aim => ({
  device,
  order: { without: entry },
  title: `Without: ${what}`,
});

/** As it was before a change, and all that came behind it. */
export const beforeChange = (device: string, entry: number, what: string): Aim => ({
  device,
  order: { before: entry },
  title: `As it was before: ${what}`,
});

type Change = Schemas["HistoryChange"];

/** A change as people say it: "write VMAX 5 → 7", "apply profile quiet, 12 registers". */
export function changeText({ entry, writes }: Change): string {
  const values =
    entry.action !== "write" || writes > 1 || entry.new === null
      ? ""
      : ` ${entry.old === null ? "" : `${entry.old} → `}${entry.new}`;
  const many = writes > 1 ? `, ${writes} registers` : "";
  return `${entry.action} ${entry.subject}`.trim() + values + many;
}
