/** F6 goes from panel to panel, Shift F6 back. */
import { useEffect } from "react";
import type { LayoutDocument } from "./document";
import { SAID } from "./layout";
import { titleOf } from "./panels";

/** The panels on the screen, in the order of the page; what has nothing to show is none. */
function inSight(): HTMLElement[] {
  return [...document.querySelectorAll<HTMLElement>("[data-panel]")].filter(
    (each) => each.childElementCount > 0 && each.checkVisibility(),
  );
}

export function useRounds(layout: LayoutDocument | undefined): void {
  useEffect(() => {
    const go = (event: KeyboardEvent) => {
      if (event.key !== "F6" || event.ctrlKey || event.altKey || event.metaKey || layout === undefined) return;
      const panels = inSight();
      const at = panels.findIndex((each) => each.contains(document.activeElement));
      const step = event.shiftKey ? -1 : 1;
      const next = panels[(at < 0 && step < 0 ? panels.length - 1 : at + step + panels.length) % panels.length];
      if (next === undefined) return;
      event.preventDefault();
      const title = titleOf(layout, next.dataset.panel ?? "");
      next.tabIndex = -1;
      next.setAttribute("role", "group");
      next.setAttribute("aria-label", title);
      next.focus();
      SAID.set(title);
    };
    window.addEventListener("keydown", go);
    return () => window.removeEventListener("keydown", go);
  }, [layout]);
}
