import { ActionIcon } from "@mantine/core";
import { IconArrowBackUp, IconLock, IconPencil } from "@tabler/icons-react";
import { memo } from "react";
import { fixed } from "../../../lib/format";
import type { RowActions } from "../../../lib/rows/actions";
import { enumName, type RegisterRow } from "../../../lib/rows/bits";
import { LiveText } from "../../../lib/rows/LiveText";
import { NumberEntry } from "../../../lib/rows/NumberEntry";
import common from "../../../lib/rows/rows.module.css";
import { type Edit, keyOf } from "../../../lib/rows/staging";
import type { Reading } from "../../../lib/rows/useRegisters";
import type { EepromAction, Kept } from "./eeprom";
import { Memory } from "./Memory";
import { controlOf, numberOf, OnDemand, ParameterValue } from "./ParameterValue";
import { type Context, meaningOf, rangeOf, scalesOf, unitText } from "./quantities";
import { nameText } from "./subjects";
import type { Asked } from "./useRead";

export interface LineActions extends RowActions {
  copy: (row: RegisterRow, action: EepromAction) => void;
  read: (row: RegisterRow) => void;
}

export interface LineProps {
  row: RegisterRow;
  reading: Reading | undefined;
  /** the module's firmware does not have it */
  lacking: boolean;
  edit: Edit | null;
  context: Context;
  selected: boolean;
  editing: boolean;
  connected: boolean;
  kept: Kept | undefined;
  copying: boolean;
  asked: Asked | undefined;
  asking: boolean;
  actions: LineActions;
}

/** One parameter in the table. */
export const ParameterLine = memo(function ParameterLine(props: LineProps) {
  const { row, edit, lacking, selected, editing, actions } = props;
  const key = keyOf(row);
  const entry = controlOf(row) === "entry" && !lacking;
  return (
    <tr
      data-row={key}
      data-selected={selected}
      data-staged={edit !== null}
      data-fate={edit?.fate?.kind}
      data-access={row.access}
      data-lacking={lacking || undefined}
      className={`${common.row} lit`}
      tabIndex={selected ? 0 : -1}
      onFocus={() => actions.select(key)}
      onClick={() => actions.select(key)}
      onDoubleClick={() => entry && actions.edit(key)}
    >
      <th scope="row" className={common.nameCell}>
        <Name row={row} />
      </th>
      <td className="num hint">{row.alias}</td>
      {lacking ? (
        <td colSpan={2}>
          <Lacking />
        </td>
      ) : row.read_clears ? (
        <td colSpan={2}>
          <OnDemand
            row={row}
            asked={props.asked}
            busy={props.asking}
            connected={props.connected}
            onRead={() => actions.read(row)}
          />
        </td>
      ) : editing && entry ? (
        <td colSpan={2}>
          <Entry {...props} />
        </td>
      ) : (
        <>
          <td className="nowrap" {...(row.fields.length > 0 ? { colSpan: 2 } : {})}>
            <Value {...props} />
          </td>
          {row.fields.length === 0 && (
            <td>
              <Meaning {...props} />
            </td>
          )}
        </>
      )}
      <td>
        {!lacking && (
          <Memory
            row={row}
            kept={props.kept}
            busy={props.copying}
            connected={props.connected}
            onCopy={(action) => actions.copy(row, action)}
          />
        )}
      </td>
      <td className={`${common.tools} nowrap`}>
        {edit && (
          <ActionIcon
            color="accent"
            size={22}
            tabIndex={-1}
            aria-label={`Discard the edit of ${nameText(row.name)}`}
            onClick={() => actions.unstage(key)}
          >
            <IconArrowBackUp size={14} />
          </ActionIcon>
        )}
        {entry && !editing && (
          <ActionIcon
            size={22}
            tabIndex={-1}
            aria-label={`Edit ${nameText(row.name)}`}
            onClick={() => actions.edit(key)}
          >
            <IconPencil size={14} />
          </ActionIcon>
        )}
      </td>
    </tr>
  );
});

export function Name({ row }: { row: RegisterRow }) {
  return (
    <span className="row gap-4 text-13 tight">
      {nameText(row.name)}
      {row.access === "R" && <IconLock size={11} className="rigid dim" aria-label="read only" />}
    </span>
  );
}

/** In place of a value. */
export function Lacking() {
  return <span className="hint">not in this firmware</span>;
}

export function Value({ row, reading, edit, context, actions }: LineProps) {
  const raw = reading?.raw ?? null;
  return (
    <ParameterValue
      row={row}
      value={numberOf(row, raw)}
      raw={raw}
      edit={edit}
      unit={unitText(row, context.mode)}
      stage={(value) => actions.stage(row, null, value, raw)}
    />
  );
}

/** What the value comes to, and of a staged one what it will be. */
export function Meaning({ row, reading, edit, context }: LineProps) {
  const now = numberOf(row, reading?.raw);
  const staged = edit?.value ?? null;
  const shown = staged ?? now;
  const text = shown === null ? "" : meaningOf(row, shown, context);
  return (
    <span className="lines-8 baseline">
      {staged !== null && (
        <span className="num rigid accent bold">
          {controlOf(row) === "entry" ? (
            <>
              <span className="mx-4 accent">→</span>
              {fixed(staged)}
            </>
          ) : (
            `was ${now === null ? "unknown" : (enumName(row, now) ?? (now === 1 ? "on" : "off"))}`
          )}
        </span>
      )}
      {text !== "" && <LiveText className="num hint breaks" text={text} />}
    </span>
  );
}

export function Entry({ row, reading, edit, context, actions }: LineProps) {
  const key = keyOf(row);
  const raw = reading?.raw ?? null;
  return (
    <NumberEntry
      bits={{ ...row, ...rangeOf(row, context.mode), unit: unitText(row, context.mode) }}
      label={`New value of ${nameText(row.name)}`}
      value={edit?.value ?? numberOf(row, raw)}
      scales={scalesOf(row, context.scale, context.mode, context.clockHz)}
      onStage={(value) => actions.stage(row, null, value, raw)}
      onDone={() => {
        actions.edit(null);
        document.querySelector<HTMLElement>(`[data-row="${CSS.escape(key)}"]`)?.focus();
      }}
    />
  );
}
