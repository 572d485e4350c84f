import { Shared, useShared } from "../lib/shared";
import type { components } from "./schema";

/** Who this page is let in as, and what it may do. */
export type Access = components["schemas"]["AccessInfo"];

const URL = "/api/v1/access";
const known = new Shared<Access | null>(null);

/** Ask the server who we are. Without an answer nothing is held back here: the server decides. */
export async function askAccess(): Promise<void> {
  const answer = await fetch(URL).catch(() => null);
  if (!answer?.ok) return;
  known.set((await answer.json()) as Access);
}

/** Whether our token only lets us look: then nothing asks for the bench, and the server says why it refuses. */
export const onlyLooks = (): boolean => known.get()?.role === "look";

export function useAccess(): Access | null {
  return useShared(known);
}

/** End the session on the server; what comes then is its form for the token, or nobody at all where none is asked for. */
export async function logOut(): Promise<void> {
  await fetch(`${URL}/log-out`, { method: "POST" });
  window.location.assign("/");
}
