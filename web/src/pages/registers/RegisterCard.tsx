import { Button, Group } from "@mantine/core";
import { IconArrowBackUp } from "@tabler/icons-react";
import { memo } from "react";
import { hex } from "../../lib/format";
import { toSigned, writable } from "../../lib/rows/bits";
import { NumberEntry } from "../../lib/rows/NumberEntry";
import { AccessMark, NameTags, PackedText, PhysicalText, RawText, RegisterName, ValueText } from "../../lib/rows/parts";
import { scalesOf, speedsOf } from "../../lib/rows/physical";
import common from "../../lib/rows/rows.module.css";
import { keyOf } from "../../lib/rows/staging";
import { RegisterHelp } from "./RegisterHelp";
import { RegisterBits, type RowProps } from "./RegisterLine";

/** One register on a phone: what it holds at a glance, everything else when opened. */
export const RegisterCard = memo(function RegisterCard(props: RowProps) {
  const { row, reading, edit, scale, clockHz, axisName, expanded, editing, actions } = props;
  const key = keyOf(row);
  const raw = reading?.raw ?? null;
  const packed = row.fields.length > 0;
  const scales = scalesOf(row.unit, scale);
  const value = raw === null ? null : row.signed ? toSigned(raw, row.width) : raw;
  const shown = edit?.value ?? value;
  return (
    <li className={`${common.card} box`} data-row={key} data-staged={edit !== null} data-fate={edit?.fate?.kind}>
      <button
        type="button"
        className="plain stack gap-4 pad w-full"
        aria-expanded={expanded}
        aria-label={`${row.name}${axisName ? ` of ${axisName}` : ""}`}
        onClick={() => {
          actions.select(key);
          actions.toggle(key);
        }}
      >
        <span className="row gap-8 shrink">
          <span className="grow">
            <RegisterName name={row.name} />
          </span>
          <NameTags row={row} />
          <span className="num dim">{hex(row.address, 8)}</span>
          <AccessMark access={row.access} />
        </span>
        <span className="row between gap-8 shrink">
          {packed ? <PackedText row={row} raw={raw} edit={edit} /> : <ValueText row={row} raw={raw} />}
          <RawText row={row} reading={reading} />
        </span>
        {(scales.length > 0 || edit) && !packed && (
          <PhysicalText
            row={row}
            raw={raw}
            edit={edit}
            scales={scales}
            also={(of) => (scale ? speedsOf(row, of, scale) : [])}
          />
        )}
      </button>
      {expanded && (
        <div className="stack start gap-8 pad">
          {!packed && writable(row.access) && (
            <Group gap="xs">
              {editing ? (
                <NumberEntry
                  bits={row}
                  label={`New value of ${row.name}`}
                  value={shown}
                  scales={scales}
                  onStage={(next) => actions.stage(row, null, next, raw)}
                  onDone={() => actions.edit(null)}
                />
              ) : (
                <Button size="compact-sm" variant="light" onClick={() => actions.edit(key)}>
                  Edit the value
                </Button>
              )}
            </Group>
          )}
          {edit && (
            <Button
              size="compact-sm"
              variant="subtle"
              leftSection={<IconArrowBackUp size={14} aria-hidden />}
              onClick={() => actions.unstage(key)}
            >
              Discard the staged edit
            </Button>
          )}
          <RegisterBits row={row} raw={raw} edit={edit} scale={scale} clockHz={clockHz} actions={actions} />
          <RegisterHelp row={row} raw={raw} beside={props.beside} actions={actions} />
        </div>
      )}
    </li>
  );
});
