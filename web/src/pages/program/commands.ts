export type Command =
  | "run"
  | "pause"
  | "stop"
  | "step"
  | "over"
  | "out"
  | "cursor"
  | "reset"
  | "breakpoint"
  | "download";

/** The keys of the page, as other debuggers have them; they work while something on the page has the focus. */
export const KEYS: Readonly<Record<Command, string>> = {
  run: "F5",
  pause: "F6",
  stop: "Shift+F5",
  step: "F11",
  over: "F10",
  out: "Shift+F11",
  cursor: "Control+F10",
  breakpoint: "F9",
  download: "Control+S",
  reset: "",
};

type Pressed = Pick<KeyboardEvent, "key" | "shiftKey" | "ctrlKey" | "metaKey" | "altKey">;

/** The command of a key; null for any other key. */
export function commandOf({ key, shiftKey, ctrlKey, metaKey, altKey }: Pressed): Command | null {
  if (altKey) return null;
  const name = `${ctrlKey || metaKey ? "Control+" : ""}${shiftKey ? "Shift+" : ""}${key.length === 1 ? key.toUpperCase() : key}`;
  const found = Object.entries(KEYS).find(([, keys]) => keys !== "" && keys === name);
  return found ? (found[0] as Command) : null;
}
