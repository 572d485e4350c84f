import { ActionIcon } from "@mantine/core";
import { IconArrowBackUp, IconChevronRight, IconPencil } from "@tabler/icons-react";
import { memo, useCallback } from "react";
import { hex } from "../../lib/format";
import type { RowActions } from "../../lib/rows/actions";
import { type RegisterRow, toSigned, writable } from "../../lib/rows/bits";
import { NumberEntry } from "../../lib/rows/NumberEntry";
import { AccessMark, NameTags, PackedText, PhysicalText, RawText, RegisterName, ValueText } from "../../lib/rows/parts";
import { fieldScales, scalesOf, speedsOf } from "../../lib/rows/physical";
import common from "../../lib/rows/rows.module.css";
import { type Edit, keyOf, stagedRaw } from "../../lib/rows/staging";
import type { Reading } from "../../lib/rows/useRegisters";
import type { AxisScale } from "../../lib/units";
import { BitStrip } from "./BitStrip";
import { FieldList } from "./FieldList";

export interface RowProps {
  row: RegisterRow;
  reading: Reading | undefined;
  edit: Edit | null;
  /** conversion to physical units; null for a register that belongs to no axis */
  scale: AxisScale | null;
  clockHz: number;
  axisName: string | null;
  found: string;
  /** what else stands at its address: "X_RANGE when written" */
  beside: string;
  selected: boolean;
  expanded: boolean;
  editing: boolean;
  actions: RowActions;
}

/** One register as a line of the table, with its bits below when opened. */
export const RegisterLine = memo(function RegisterLine(props: RowProps) {
  const { row, reading, edit, scale, clockHz, axisName, found, selected, expanded, editing, actions } = props;
  const key = keyOf(row);
  const raw = reading?.raw ?? null;
  const packed = row.fields.length > 0;
  const scales = scalesOf(row.unit, scale);
  const value = raw === null ? null : row.signed ? toSigned(raw, row.width) : raw;
  const done = useCallback(() => {
    actions.edit(null);
    document.querySelector<HTMLElement>(`[data-row="${CSS.escape(key)}"]`)?.focus();
  }, [actions, key]);

  return (
    <>
      <tr
        data-row={key}
        data-selected={selected}
        data-staged={edit !== null}
        data-fate={edit?.fate?.kind}
        data-access={row.access}
        className={`${common.row} lit`}
        tabIndex={selected ? 0 : -1}
        onFocus={() => actions.select(key)}
        onClick={() => actions.select(key)}
        onDoubleClick={() => (packed ? actions.toggle(key) : writable(row.access) && actions.edit(key))}
      >
        <td className={common.chevronCell}>
          <ActionIcon
            size={22}
            variant="transparent"
            tabIndex={-1}
            aria-label={`Bits of ${row.name}${axisName ? ` of ${axisName}` : ""}`}
            aria-expanded={expanded}
            onClick={() => actions.toggle(key)}
          >
            <IconChevronRight size={14} className="chevron" data-open={expanded} />
          </ActionIcon>
        </td>
        <th scope="row" className={common.nameCell}>
          <RegisterName name={row.name} />
          <NameTags row={row} />
          {found !== "" && <span className="clip block accent text-12">{found}</span>}
        </th>
        <td className="num">{hex(row.address, 8)}</td>
        <td>
          <AccessMark access={row.access} />
        </td>
        <td>
          <RawText row={row} reading={reading} />
        </td>
        {packed ? (
          <td colSpan={2}>
            <PackedText row={row} raw={raw} edit={edit} />
          </td>
        ) : editing ? (
          <td colSpan={2}>
            <NumberEntry
              bits={row}
              label={`New value of ${row.name}`}
              value={edit?.value ?? value}
              scales={scales}
              onStage={(next) => actions.stage(row, null, next, raw)}
              onDone={done}
            />
          </td>
        ) : (
          <>
            <td className="nowrap">
              <ValueText row={row} raw={raw} />
            </td>
            <td>
              <PhysicalText
                row={row}
                raw={raw}
                edit={edit}
                scales={scales}
                also={(of) => (scale ? speedsOf(row, of, scale) : [])}
              />
            </td>
          </>
        )}
        <td className={`${common.tools} nowrap`}>
          {edit && !editing && (
            <ActionIcon
              color="accent"
              size={22}
              tabIndex={-1}
              aria-label={`Discard the edits of ${row.name}`}
              onClick={() => actions.unstage(key)}
            >
              <IconArrowBackUp size={14} />
            </ActionIcon>
          )}
          {writable(row.access) && !editing && (
            <ActionIcon
              size={22}
              tabIndex={-1}
              aria-label={`Edit ${row.name}${axisName ? ` of ${axisName}` : ""}`}
              onClick={() => (packed ? actions.toggle(key, true) : actions.edit(key))}
            >
              <IconPencil size={14} />
            </ActionIcon>
          )}
        </td>
      </tr>
      {expanded && (
        <tr className={common.detailRow}>
          <td colSpan={8}>
            <RegisterBits row={row} raw={raw} edit={edit} scale={scale} clockHz={clockHz} actions={actions} />
          </td>
        </tr>
      )}
    </>
  );
});

type BitsProps = Pick<RowProps, "row" | "edit" | "scale" | "clockHz" | "actions"> & { raw: number | null };

/** The strip and the field editors, in the table and on a card. */
export function RegisterBits({ row, raw, edit, scale, clockHz, actions }: BitsProps) {
  const key = keyOf(row);
  return (
    <div className="stack gap-8 w-full" data-detail={key}>
      <BitStrip
        row={row}
        raw={raw}
        staged={edit ? stagedRaw(edit, row, raw) : null}
        onPick={(field) =>
          document
            .querySelector<HTMLElement>(
              `[data-detail="${CSS.escape(key)}"] [data-field="${CSS.escape(field)}"] :is(input, button)`,
            )
            ?.focus()
        }
      />
      {row.fields.length > 0 && (
        <FieldList
          row={row}
          raw={raw}
          edit={edit}
          scalesOf={(field) => fieldScales(field, scale)}
          clockHz={clockHz}
          stage={(field, value) => actions.stage(row, field, value, raw)}
          unstage={(field) => actions.unstage(key, field)}
        />
      )}
    </div>
  );
}
