/** Of the 64 kB that a layout may have. */
export const NOTES_MAX = 10_000;

export interface NotesConfig {
  text: string;
}

export function readNotes({ text }: Readonly<Record<string, unknown>>): NotesConfig {
  return { text: typeof text === "string" ? text.slice(0, NOTES_MAX) : "" };
}
