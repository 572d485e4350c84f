import { Button, Skeleton, Text } from "@mantine/core";
import { IconChevronRight, IconSearchOff } from "@tabler/icons-react";
import type { KeyboardEvent } from "react";
import { EmptyState } from "../../lib/EmptyState";
import { type RegisterRow, writable } from "../../lib/rows/bits";
import common from "../../lib/rows/rows.module.css";
import { type Group, matchingFields } from "../../lib/rows/search";
import { type Edit, type Key, keyOf } from "../../lib/rows/staging";
import type { Reading } from "../../lib/rows/useRegisters";
import type { AxisScale } from "../../lib/units";
import { RegisterCard } from "./RegisterCard";
import { RegisterLine, type RowActions } from "./RegisterLine";

interface Props {
  phone: boolean;
  loading: boolean;
  groups: readonly Group[];
  query: string;
  isFolded: (group: Group) => boolean;
  onFold: (key: string, folded: boolean) => void;
  readings: ReadonlyMap<Key, Reading>;
  edits: readonly Edit[];
  open: ReadonlySet<Key>;
  editing: Key | null;
  selected: Key | null;
  scales: readonly AxisScale[];
  clockHz: number;
  axisNames: readonly string[];
  showAxis: boolean;
  old: boolean;
  actions: RowActions;
  onClearSearch: () => void;
}

/** All groups of registers, as a table or, on a phone, as cards. */
export function RegisterList(props: Props) {
  const { phone, loading, groups, query, isFolded, old, axisNames, onFold } = props;
  if (loading) return <Loading />;
  if (groups.length === 0)
    return (
      <EmptyState title={`No register matches "${query}"`} icon={<IconSearchOff size={22} />}>
        <Text size="sm" className={common.dim}>
          Search finds names, addresses like 0x0c, fields and words of the help.
        </Text>
        <Button size="xs" variant="default" onClick={props.onClearSearch}>
          Clear the search
        </Button>
      </EmptyState>
    );

  const titleOf = (group: Group) => {
    if (group.axis !== null && props.showAxis)
      return `${axisNames[group.axis] ?? `axis ${group.axis}`} · ${group.title}`;
    const twice = groups.some((other) => other !== group && other.title === group.title);
    return group.axis === null && twice ? `${group.title} of the whole chip` : group.title;
  };
  const entry = (row: RegisterRow) => {
    const key = keyOf(row);
    const tabStop = props.selected ?? keyOf(groups[0]?.rows[0] ?? row);
    return {
      row,
      reading: props.readings.get(key),
      edit: props.edits.find((edit) => keyOf(edit) === key) ?? null,
      scale: row.axis === null ? null : (props.scales[row.axis] ?? null),
      clockHz: props.clockHz,
      axisName: props.showAxis && row.axis !== null ? (axisNames[row.axis] ?? `axis ${row.axis}`) : null,
      found: matchingFields(row, query).slice(0, 3).join(", "),
      selected: tabStop === key,
      expanded: props.open.has(key),
      editing: props.editing === key,
      actions: props.actions,
    };
  };
  const stagedIn = (group: Group) =>
    props.edits.filter((edit) => group.rows.some((row) => keyOf(row) === keyOf(edit))).length;

  if (phone)
    return (
      <div data-old={old} className={common.values}>
        {groups.map((group) => (
          <section key={group.key}>
            <GroupHead
              group={group}
              title={titleOf(group)}
              folded={isFolded(group)}
              staged={stagedIn(group)}
              onFold={onFold}
            />
            {!isFolded(group) && (
              <ul className={common.cards}>
                {group.rows.map((row) => (
                  <RegisterCard key={keyOf(row)} {...entry(row)} />
                ))}
              </ul>
            )}
          </section>
        ))}
      </div>
    );

  return (
    // The rows take the focus; the table only hears their keys.
    <table
      className={`${common.table} ${common.values}`}
      data-old={old}
      onKeyDown={(event) => onTableKey(event, groups, props.open, props.actions)}
    >
      <caption className={common.hidden}>
        Registers. Arrow keys walk the rows, Enter edits, right opens the bits.
      </caption>
      <colgroup>
        <col style={{ width: 30 }} />
        <col className={common.colName} />
        <col style={{ width: 48 }} />
        <col style={{ width: 58 }} />
        <col style={{ width: 84 }} />
        <col className={common.colValue} />
        <col />
        <col style={{ width: 56 }} />
      </colgroup>
      <thead>
        <tr>
          <td />
          <th scope="col">Register</th>
          <th scope="col">Addr</th>
          <th scope="col">Access</th>
          <th scope="col">Raw</th>
          <th scope="col">Value</th>
          <th scope="col">Physical</th>
          <td />
        </tr>
      </thead>
      {groups.map((group) => (
        <tbody key={group.key}>
          <tr className={common.groupRow}>
            <th colSpan={8} scope="rowgroup">
              <GroupHead
                group={group}
                title={titleOf(group)}
                folded={isFolded(group)}
                staged={stagedIn(group)}
                onFold={onFold}
              />
            </th>
          </tr>
          {!isFolded(group) && group.rows.map((row) => <RegisterLine key={keyOf(row)} {...entry(row)} />)}
        </tbody>
      ))}
    </table>
  );
}

interface HeadProps {
  group: Group;
  title: string;
  folded: boolean;
  staged: number;
  onFold: (key: string, folded: boolean) => void;
}

function GroupHead({ group, title, folded, staged, onFold }: HeadProps) {
  return (
    <button
      type="button"
      className={common.groupHead}
      data-row={`group ${group.key}`}
      aria-expanded={!folded}
      onClick={() => onFold(group.key, !folded)}
    >
      <IconChevronRight size={13} className={common.chevron} data-open={!folded} aria-hidden />
      {title.charAt(0).toUpperCase() + title.slice(1)}
      <span className={common.groupCount}>{group.rows.length}</span>
      {staged > 0 && <span className={common.badge}>{staged}</span>}
    </button>
  );
}

function Loading() {
  return (
    <div aria-busy="true" role="status" aria-label="Reading the register list">
      {Array.from({ length: 14 }, (_, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: equal bars that never change places
        <Skeleton key={index} height={22} mb={7} radius="sm" />
      ))}
    </div>
  );
}

/** Up and down walk, right and left open and close, Enter edits. Only where a row itself has the focus. */
function onTableKey(
  event: KeyboardEvent<HTMLTableElement>,
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
      else if (writable(row.access)) actions.edit(key);
      break;
    default:
      return;
  }
  event.preventDefault();
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
