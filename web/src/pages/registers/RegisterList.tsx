import { Button, Text } from "@mantine/core";
import { IconSearchOff } from "@tabler/icons-react";
import { EmptyState } from "../../lib/EmptyState";
import type { RowActions } from "../../lib/rows/actions";
import { type RegisterRow, readable } from "../../lib/rows/bits";
import common from "../../lib/rows/rows.module.css";
import { besideText, type Group, matchingFields } from "../../lib/rows/search";
import { type Edit, type Key, keyOf } from "../../lib/rows/staging";
import { GroupHead, onTableKey, RowsLoading } from "../../lib/rows/table";
import type { Reading } from "../../lib/rows/useRegisters";
import type { AxisScale } from "../../lib/units";
import { RegisterCard } from "./RegisterCard";
import { RegisterLine } from "./RegisterLine";

interface Props {
  phone: boolean;
  loading: boolean;
  groups: readonly Group[];
  /** all rows, whatever the search finds */
  rows: readonly RegisterRow[];
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

/** What was read of the word whose second name that is. */
function plainReading(row: RegisterRow, { rows, readings }: Pick<Props, "rows" | "readings">): Reading | undefined {
  if (!readable(row.access)) return undefined;
  const first = rows.find((other) => other.address === row.address && readable(other.access) && !other.when);
  return first && readings.get(keyOf(first));
}

/** All groups of registers, as a table or, on a phone, as cards. */
export function RegisterList(props: Props) {
  const { phone, loading, groups, query, isFolded, old, axisNames, onFold } = props;
  if (loading) return <RowsLoading what="register" />;
  if (groups.length === 0)
    return (
      <EmptyState title={`No register matches "${query}"`} icon={<IconSearchOff size={22} />}>
        <Text size="sm" className="dim">
          Search finds names, addresses like 0x0c, fields and words of the help.
        </Text>
        <Button variant="default" onClick={props.onClearSearch}>
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
      reading: props.readings.get(key) ?? (row.when ? plainReading(row, props) : undefined),
      edit: props.edits.find((edit) => keyOf(edit) === key) ?? null,
      scale: row.axis === null ? null : (props.scales[row.axis] ?? null),
      clockHz: props.clockHz,
      axisName: props.showAxis && row.axis !== null ? (axisNames[row.axis] ?? `axis ${row.axis}`) : null,
      beside: besideText(row, props.rows),
      found: matchingFields(row, query).slice(0, 3).join(", "),
      selected: tabStop === key,
      expanded: props.open.has(key),
      editing: props.editing === key,
      actions: props.actions,
    };
  };
  const head = (group: Group) => (
    <GroupHead
      group={group}
      title={titleOf(group)}
      folded={isFolded(group)}
      staged={props.edits.filter((edit) => group.rows.some((row) => keyOf(row) === keyOf(edit))).length}
      onFold={onFold}
    />
  );

  if (phone)
    return (
      <div data-old={old} className={common.values}>
        {groups.map((group) => (
          <section key={group.key}>
            {head(group)}
            {!isFolded(group) && (
              <ul className="list mb-8">
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
      <caption className="unseen">Registers. Arrow keys walk the rows, Enter edits, right opens the bits.</caption>
      <colgroup>
        <col style={{ width: 30 }} />
        <col className={common.colName} />
        <col style={{ width: 48 }} />
        <col style={{ width: 58 }} />
        <col style={{ width: 90 }} />
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
          <tr>
            <th colSpan={8} scope="rowgroup" className="p-0">
              {head(group)}
            </th>
          </tr>
          {!isFolded(group) && group.rows.map((row) => <RegisterLine key={keyOf(row)} {...entry(row)} />)}
        </tbody>
      ))}
    </table>
  );
}
