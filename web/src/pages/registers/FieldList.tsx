import { ActionIcon, Button, Checkbox, Select } from "@mantine/core";
import { IconArrowBackUp } from "@tabler/icons-react";
import { fixed } from "../../lib/format";
import { editorOf, enumName, type FieldRow, type RegisterRow, unpackField, writable } from "../../lib/rows/bits";
import type { Scale } from "../../lib/rows/input";
import { LiveText } from "../../lib/rows/LiveText";
import { NumberEntry } from "../../lib/rows/NumberEntry";
import { chipUnit, derived, physicalText } from "../../lib/rows/physical";
import type { Edit } from "../../lib/rows/staging";
import css from "./registers.module.css";

interface Props {
  row: RegisterRow;
  raw: number | null;
  edit: Edit | null;
  scalesOf: (field: FieldRow) => readonly Scale[];
  clockHz: number;
  stage: (field: FieldRow, value: number) => void;
  unstage: (field: string) => void;
}

/** Every field of a packed register, highest bits first as on the strip, each with the editor that suits it. */
export function FieldList(props: Props) {
  const { row, raw, edit, stage, unstage, scalesOf, clockHz } = props;
  const ordered = [...row.fields].sort((a, b) => b.lsb - a.lsb);
  // plain names first, then under each condition what the bits are called by it
  const conditions = [...new Set(ordered.map((field) => field.when ?? ""))].sort((a, b) => a.localeCompare(b));
  return conditions.map((condition) => (
    <div key={condition}>
      {condition !== "" && <h3 className="hint bold m-0 mt-8">If {condition}</h3>}
      <ul className="list">
        {ordered
          .filter((field) => (field.when ?? "") === condition)
          .map((field) => {
            const chip = raw === null ? null : unpackField(raw, field);
            const staged = edit?.fields[field.name];
            const scales = scalesOf(field);
            const shown = staged ?? chip;
            return (
              <li
                key={field.name}
                className={`${css.field} staged`}
                data-staged={staged !== undefined}
                data-field={field.name}
              >
                <span className="num hint right">
                  {field.width === 1 ? field.lsb : `${field.lsb + field.width - 1}:${field.lsb}`}
                </span>
                <span className="text-12 mono anywhere">{field.name}</span>
                <span className="row wrap gap-8">
                  <FieldControl
                    row={row}
                    field={field}
                    chip={chip}
                    staged={staged}
                    scales={scales}
                    stage={(value) => stage(field, value)}
                    unstage={() => unstage(field.name)}
                  />
                </span>
                <span className="row hint wrap gap-8">
                  {shown !== null && (physicalText(shown, scales) || derived(field, shown, clockHz))}
                  {staged !== undefined && (
                    <span className="inline gap-4 accent">
                      {field.access !== "R+WC" &&
                        `was ${chip === null ? "unknown" : (enumName(field, chip) ?? fixed(chip))}`}
                      <ActionIcon
                        color="accent"
                        size={20}
                        aria-label={`Discard the edit of ${field.name}`}
                        title="Discard this edit"
                        onClick={() => unstage(field.name)}
                      >
                        <IconArrowBackUp size={13} />
                      </ActionIcon>
                    </span>
                  )}
                </span>
                <span className="hint tight">
                  {field.help}
                  {field.behaviour && ` (the emulator keeps it without acting on it: ${field.behaviour})`}
                </span>
              </li>
            );
          })}
      </ul>
    </div>
  ));
}

interface ControlProps {
  row: RegisterRow;
  field: FieldRow;
  chip: number | null;
  staged: number | undefined;
  scales: readonly Scale[];
  stage: (value: number) => void;
  unstage: () => void;
}

function FieldControl({ row, field, chip, staged, scales, stage, unstage }: ControlProps) {
  const label = `${field.name} of ${row.name}`;
  const shown = staged ?? chip;
  const text = shown === null ? "–" : (enumName(field, shown) ?? fixed(shown));
  if (field.access === "R+WC") {
    return (
      <>
        <LiveText className={css.flag} text={chip === null ? "–" : chip === 1 ? "set" : "not set"} />
        <Button
          size="compact-xs"
          variant={staged === 1 ? "filled" : "default"}
          aria-pressed={staged === 1}
          aria-label={`Clear ${label}`}
          onClick={() => (staged === 1 ? unstage() : stage(1))}
        >
          {staged === 1 ? "will clear" : "clear"}
        </Button>
      </>
    );
  }
  if (!writable(field.access) || !writable(row.access)) {
    return (
      <span>
        <LiveText className="num" text={text} /> <span className="hint ml-4">{chipUnit(field.unit)}</span>
        <span className="hint ml-8">read only</span>
      </span>
    );
  }
  const kind = editorOf(field);
  if (kind === "check") {
    return (
      <Checkbox
        label={shown === null ? "–" : shown === 1 ? "on" : "off"}
        aria-label={label}
        checked={shown === 1}
        indeterminate={shown === null}
        onChange={(event) => stage(event.currentTarget.checked ? 1 : 0)}
      />
    );
  }
  if (kind === "select") {
    const options = Object.entries(field.values)
      .map(([value, name]) => ({ value, label: `${value} · ${name}` }))
      .filter(({ value }) => Number(value) >= field.minimum && Number(value) <= field.maximum);
    if (shown !== null && enumName(field, shown) === undefined)
      options.push({ value: String(shown), label: `${shown} · without a name` });
    return (
      <Select
        w={198}
        aria-label={label}
        data={options}
        value={shown === null ? null : String(shown)}
        placeholder="not known"
        onChange={(value) => value !== null && stage(Number(value))}
      />
    );
  }
  return <NumberEntry bits={field} label={label} value={shown} scales={scales} onStage={stage} />;
}
