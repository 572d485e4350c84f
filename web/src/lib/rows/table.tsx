import { Skeleton } from "@mantine/core";
import { IconChevronRight } from "@tabler/icons-react";
import type { KeyboardEvent } from "react";
import type { RowActions } from "./actions";
import { type RegisterRow, writable } from "./bits";
import type { Group } from "./search";
import { type Key, keyOf } from "./staging";

interface HeadProps {
  group: Group;
  title: string;
  folded: boolean;
  staged: number;
  onFold: (key: string, folded: boolean) => void;
}

export function GroupHead({ group, title, folded, staged, onFold }: HeadProps) {
  return (
    <button
      type="button"
      className="plain row gap-6 pad-s raised rule-bottom text-12 bold w-full"
      data-row={`group ${group.key}`}
      aria-expanded={!folded}
      onClick={() => onFold(group.key, !folded)}
    >
      <IconChevronRight size={13} className="chevron" data-open={!folded} aria-hidden />
      {title.charAt(0).toUpperCase() + title.slice(1)}
      <span className="dim regular">{group.rows.length}</span>
      {staged > 0 && <span className="count">{staged}</span>}
    </button>
  );
}

export function RowsLoading({ what }: { what: string }) {
  return (
    <div aria-busy="true" role="status" aria-label={`Reading the ${what} list`}>
      {Array.from({ length: 14 }, (_, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: equal bars that never change places
        <Skeleton key={index} height={22} mb={7} radius="sm" />
      ))}
    </div>
  );
}

/** Up and down walk, right and left open and close, Enter edits. Only where a row itself has the focus. */
export function onTableKey(
  event: KeyboardEvent<HTMLElement>,
  groups: readonly Group[],
  open: ReadonlySet<Key>,
  actions: RowActions,
): void {
  const target = event.target as HTMLElement;
  const key = target.dataset.row;
  if (key === undefined || event.altKey || event.ctrlKey || event.metaKey) return;
  const row = groups.flatMap((group) => group.rows).find((candidate) => keyOf(candidate) === key);
  const walk = (by: number) => {
    const all = [...event.currentTarget.querySelectorAll<HTMLElement>("[data-row]")];
    all[Math.max(0, Math.min(all.length - 1, all.indexOf(target) + by))]?.focus();
  };
  switch (event.key) {
    case "ArrowDown":
      walk(1);
      break;
    case "ArrowUp":
      walk(-1);
      break;
    case "PageDown":
      walk(10);
      break;
    case "PageUp":
      walk(-10);
      break;
    case "Home":
      walk(Number.NEGATIVE_INFINITY);
      break;
    case "End":
      walk(Number.POSITIVE_INFINITY);
      break;
    case "ArrowRight":
      if (row) actions.toggle(key, true);
      else if (target.getAttribute("aria-expanded") === "false") target.click();
      break;
    case "ArrowLeft":
      if (row) actions.toggle(key, false);
      else if (target.getAttribute("aria-expanded") === "true") target.click();
      break;
    case "Enter":
      if (!row) return; // the group's own button
      if (row.fields.length > 0) enterFields(key, open, actions);
      else enterValue(target, row, key, actions);
      break;
    default:
      return;
  }
  event.preventDefault();
}

/** Goes to the control that stands in the row all the time, or opens the entry. */
function enterValue(target: HTMLElement, row: RegisterRow, key: Key, actions: RowActions): void {
  const control = target.querySelector<HTMLElement>("[data-control] :is(input, select, button):not(:disabled)");
  if (control) control.focus();
  else if (writable(row.access)) actions.edit(key);
}

/** Opens a packed register and goes to its first editor. */
function enterFields(key: Key, open: ReadonlySet<Key>, actions: RowActions): void {
  actions.toggle(key, true);
  const focus = () =>
    document
      .querySelector<HTMLElement>(`[data-detail="${CSS.escape(key)}"] [data-field] :is(input, button):not(:disabled)`)
      ?.focus();
  if (open.has(key)) focus();
  else requestAnimationFrame(() => requestAnimationFrame(focus));
}
