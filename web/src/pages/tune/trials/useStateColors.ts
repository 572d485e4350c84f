import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";

/** Colours of trials that held and of those that did not: blue and red, which all eyes tell apart. */
export function useStateColors(): { held: string; lost: string } {
  const scheme = useScheme();
  return { held: colorOf("position", scheme), lost: scheme === "dark" ? "#ff8787" : "#c92a2a" };
}
