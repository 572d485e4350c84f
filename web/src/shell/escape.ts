import type { QueryClient } from "@tanstack/react-query";

/** What Escape closes: dialogs, menus, lists, and entries that are being written in. */
const OPEN = '[role="dialog"], [role="menu"], [role="listbox"], [data-escape-closes]';
const ENTRY = "input:not([type=checkbox], [type=radio], [type=range], [type=button]), textarea, [contenteditable=true]";

function isShown(element: Element): boolean {
  return element.checkVisibility?.() ?? true;
}

/** Whether Escape has anything else to do than to stop: something is open, or an entry has the focus. */
export function hasSomethingToClose(page: Document = document): boolean {
  return page.activeElement?.matches(ENTRY) === true || [...page.querySelectorAll(OPEN)].some(isShown);
}

/** The library's dropdowns hear the key only while the focus is in them; the newest of those that have it not closes. */
export function closeWithoutFocus(page: Document = document): void {
  const open = [...page.querySelectorAll<HTMLElement>(".mantine-Popover-dropdown, .mantine-Menu-dropdown")].filter(
    isShown,
  );
  const newest = open.at(-1);
  if (page.querySelector('[aria-modal="true"]')) return;
  if (newest && !open.some((dropdown) => dropdown.contains(page.activeElement)))
    newest.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape", bubbles: true }));
}

/** Whether an axis goes there and back, as far as this page was told: one that waits at an end goes on by itself. */
export function shuttleRuns(queries: QueryClient): boolean {
  return queries
    .getQueriesData<{ running?: boolean }>({ queryKey: ["shuttle"] })
    .some(([, shuttle]) => shuttle?.running === true);
}
