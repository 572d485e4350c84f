/** One wording for what is known of a write, on every page. */
export const READ_BACK = "read back";
export const WRITTEN_BLIND = "written, cannot be read back";

/** `verified` of the server's answer: null where the chip cannot tell, or changes the register by itself. */
export function proofOf({ verified, note = "" }: { verified: boolean | null; note?: string }): string {
  if (verified === true) return READ_BACK;
  if (verified === false) return "reads back as something else";
  return note.includes("cannot be read") ? WRITTEN_BLIND : "written, a read-back proves nothing";
}
