import { Button, Text } from "@mantine/core";
import { IconSearchOff } from "@tabler/icons-react";
import { EmptyState } from "../../../lib/EmptyState";
import type { RegisterRow } from "../../../lib/rows/bits";
import common from "../../../lib/rows/rows.module.css";
import type { Group } from "../../../lib/rows/search";
import { type Edit, type Key, keyOf } from "../../../lib/rows/staging";
import { GroupHead, onTableKey, RowsLoading } from "../../../lib/rows/table";
import type { Reading } from "../../../lib/rows/useRegisters";
import type { Kept } from "./eeprom";
import { ParameterCard } from "./ParameterCard";
import { type LineActions, ParameterLine } from "./ParameterLine";
import css from "./parameters.module.css";
import type { Context } from "./quantities";
import type { Asked } from "./useRead";

interface Props {
  phone: boolean;
  loading: boolean;
  groups: readonly Group[];
  query: string;
  isFolded: (group: Group) => boolean;
  onFold: (key: string, folded: boolean) => void;
  readings: ReadonlyMap<Key, Reading>;
  /** what the module's firmware does not have */
  lacking: ReadonlySet<Key>;
  edits: readonly Edit[];
  open: ReadonlySet<Key>;
  editing: Key | null;
  selected: Key | null;
  context: Context;
  connected: boolean;
  old: boolean;
  kept: ReadonlyMap<Key, Kept>;
  copying: Key | null;
  answers: ReadonlyMap<Key, Asked>;
  asking: Key | null;
  actions: LineActions;
  onClearSearch: () => void;
}

/** Parameters by subject, as a table or, on a phone, as cards. */
export function ParameterList(props: Props) {
  const { phone, loading, groups, query, isFolded, onFold, old, open, actions } = props;
  if (loading) return <RowsLoading what="parameter" />;
  if (groups.length === 0)
    return (
      <EmptyState title={`No parameter matches "${query}"`} icon={<IconSearchOff size={22} />}>
        <Text size="sm" className="dim">
          Search finds names, numbers like AP 4, names of values and words of the help.
        </Text>
        <Button variant="default" onClick={props.onClearSearch}>
          Clear the search
        </Button>
      </EmptyState>
    );

  const entry = (row: RegisterRow) => {
    const key = keyOf(row);
    const tabStop = props.selected ?? keyOf(groups[0]?.rows[0] ?? row);
    return {
      row,
      reading: props.readings.get(key),
      lacking: props.lacking.has(key),
      edit: props.edits.find((edit) => keyOf(edit) === key) ?? null,
      context: props.context,
      selected: tabStop === key,
      editing: props.editing === key,
      connected: props.connected,
      kept: props.kept.get(key),
      copying: props.copying === key,
      asked: props.answers.get(key),
      asking: props.asking === key,
      actions,
    };
  };
  const head = (group: Group) => (
    <GroupHead
      group={group}
      title={group.title}
      folded={isFolded(group)}
      staged={props.edits.filter((edit) => group.rows.some((row) => keyOf(row) === keyOf(edit))).length}
      onFold={onFold}
    />
  );

  if (phone)
    return (
      <div data-old={old} className={common.values}>
        {groups.map((group) => (
          <section key={group.key} data-subject={group.key}>
            {head(group)}
            {!isFolded(group) && (
              <ul className="list mb-8">
                {group.rows.map((row) => (
                  <ParameterCard key={keyOf(row)} {...entry(row)} expanded={open.has(keyOf(row))} />
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
      className={`${common.table} ${common.values} ${css.table}`}
      data-old={old}
      onKeyDown={(event) => onTableKey(event, groups, open, actions)}
    >
      <caption className="unseen">Parameters. Arrow keys walk the rows, Enter edits.</caption>
      <colgroup>
        <col className={css.colName} />
        <col className={css.colAlias} />
        <col className={css.colValue} />
        <col />
        <col className={css.colMemory} />
        <col className={css.colTools} />
      </colgroup>
      <thead>
        <tr>
          <th scope="col">Parameter</th>
          <th scope="col">Number</th>
          <th scope="col">Value</th>
          <th scope="col">Physical</th>
          <th scope="col">Memory</th>
          <td />
        </tr>
      </thead>
      {groups.map((group) => (
        <tbody key={group.key} data-subject={group.key}>
          <tr>
            <th colSpan={6} scope="rowgroup" className="p-0">
              {head(group)}
            </th>
          </tr>
          {!isFolded(group) && group.rows.map((row) => <ParameterLine key={keyOf(row)} {...entry(row)} />)}
        </tbody>
      ))}
    </table>
  );
}
