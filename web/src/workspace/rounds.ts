/** F6 goes from panel to panel, Shift F6 back. */
import type { LayoutDocument } from "./document";
import { FOUND, SAID } from "./layout";
import { titleOf } from "./panels";

/** The panels on the screen, in the order of the page; what has nothing to show is none. */
function inSight(): HTMLElement[] {
  return [...document.querySelectorAll<HTMLElement>("[data-panel]")].filter(
    (each) => each.childElementCount > 0 && each.checkVisibility(),
  );
}

/** To the next panel; where none is there yet, to the first one that comes. */
export function goRound(layout: () => LayoutDocument, back: boolean): void {
  const panels = inSight();
  const at = panels.findIndex((each) => each.contains(document.activeElement));
  const step = back ? -1 : 1;
  const next = panels[(at < 0 && step < 0 ? panels.length - 1 : at + step + panels.length) % panels.length];
  if (next === undefined) {
    const end = FOUND.subscribe(() => {
      end();
      requestAnimationFrame(() => inSight().length > 0 && goRound(layout, back));
    });
    return;
  }
  const title = titleOf(layout(), next.dataset.panel ?? "");
  next.tabIndex = -1;
  next.setAttribute("role", "group");
  next.setAttribute("aria-label", title);
  next.focus();
  SAID.set(title);
}
