import { ActionIcon, Button, Group, Text } from "@mantine/core";
import { IconArrowBackUp, IconCheck, IconListCheck } from "@tabler/icons-react";
import type { ReactNode } from "react";
import { EmptyState } from "../EmptyState";
import { fixed, hex } from "../format";
import { ProblemAlert } from "../ProblemAlert";
import { timeOf } from "../time";
import { enumName, type RegisterRow, readable } from "./bits";
import { RegisterName } from "./parts";
import { proofOf } from "./proof";
import css from "./rows.module.css";
import { type Applied, type Change, changes, countChanges, type Edit, type Key, keyOf } from "./staging";
import type { Staged } from "./store";
import type { Reading } from "./useRegisters";

interface Props {
  what: { one: string; many: string };
  staged: Staged;
  rows: ReadonlyMap<Key, RegisterRow>;
  readings: ReadonlyMap<Key, Reading>;
  axisNames: readonly string[];
  error: unknown;
  busy: boolean;
  canApply: boolean;
  onApply: () => void;
  onDiscard: (key: Key | null, field?: string) => void;
}

/** The diff that waits, in the order in which it will be sent, and how the last one fared. */
export function ChangesPanel(props: Props) {
  const { what, staged, rows, readings, axisNames, error, busy, canApply, onApply, onDiscard } = props;
  const count = countChanges(staged.edits);
  const many = (row: { axis: number | null }) => (row.axis === null || axisNames.length < 2 ? "" : axisNames[row.axis]);
  return (
    <div>
      {error !== null && <ProblemAlert error={error} doing={`Writing ${what.many}`} />}
      {count === 0 && staged.applied.length === 0 && (
        <EmptyState title="Nothing staged" icon={<IconListCheck size={22} />}>
          <Text size="sm" className="dim" maw={260}>
            Edit a value or a field in the table. Edits gather here and reach the device only when you apply them.
          </Text>
        </EmptyState>
      )}
      {count > 0 && (
        <>
          <Group gap="xs" mb="xs">
            <Button size="compact-sm" loading={busy} disabled={!canApply} onClick={onApply}>
              Apply {count === 1 ? "1 edit" : `${count} edits`}
            </Button>
            <Button size="compact-sm" variant="default" disabled={busy} onClick={() => onDiscard(null)}>
              Discard all
            </Button>
          </Group>
          <ol className="list">
            {staged.edits.map((edit) => {
              const key = keyOf(edit);
              const row = rows.get(key);
              return (
                row && (
                  <DiffEntry
                    key={key}
                    edit={edit}
                    row={row}
                    axis={many(row) ?? ""}
                    chip={readings.get(key)?.raw ?? null}
                    onDiscard={(field) => onDiscard(key, field)}
                  />
                )
              );
            })}
          </ol>
        </>
      )}
      {staged.applied.length > 0 && (
        <>
          <h2 className="hint m-0 mt-12 mb-8">
            Written {staged.appliedAt !== null && `at ${timeOf(staged.appliedAt)}`}
          </h2>
          <ul className="list">
            {staged.applied.map((done) => {
              const row = rows.get(keyOf(done.edit));
              return row && <AppliedEntry key={keyOf(done.edit)} applied={done} row={row} axis={many(row) ?? ""} />;
            })}
          </ul>
        </>
      )}
    </div>
  );
}

interface DiffProps {
  edit: Edit;
  row: RegisterRow;
  axis: string;
  chip: number | null;
  onDiscard: (field?: string) => void;
}

function DiffEntry({ edit, row, axis, chip, onDiscard }: DiffProps) {
  const moved = !row.volatile && edit.base !== null && chip !== null && edit.base !== chip && edit.fate === null;
  return (
    <li className={`${css.diffEntry} pad-s box mb-4`} data-fate={edit.fate?.kind}>
      <Title row={row} axis={axis}>
        <Discard label={`Discard the edits of ${row.name}`} onClick={() => onDiscard()} />
      </Title>
      {changes(edit, row, chip).map((change) => (
        <div key={change.field?.name ?? ""} className="room row gap-8 text-12">
          <span className="hint mono anywhere">{change.field?.name ?? "value"}</span>
          <DiffValues row={row} change={change} />
          {row.fields.length > 0 && (
            <Discard
              label={`Discard the edit of ${change.field?.name ?? row.name}`}
              onClick={() => onDiscard(change.field?.name)}
            />
          )}
        </div>
      ))}
      {edit.fate && <FateText edit={edit} row={row} />}
      {moved && edit.base !== null && (
        <Text size="xs" className="dim">
          It changed since you began: it held {hex(edit.base, row.width)}.
        </Text>
      )}
    </li>
  );
}

function DiffValues({ row, change }: { row: RegisterRow; change: Change }) {
  const text = (value: number) => (change.field ? enumName(change.field, value) : enumName(row, value)) ?? fixed(value);
  if (change.field?.access === "R+WC") return <span className="push right breaks">clear the flag</span>;
  return (
    <span className="num push right breaks">
      <span className="dim">{change.from === null ? "?" : text(change.from)}</span>
      <span className="mx-4 accent">→</span>
      <b className="rigid accent bold">{text(change.to)}</b>
    </span>
  );
}

function FateText({ edit, row }: { edit: Edit; row: RegisterRow }) {
  const fate = edit.fate;
  if (fate === null) return null;
  if (fate.kind === "not tried")
    return (
      <Text size="xs" className="dim">
        Not tried: an edit before it failed. Still staged.
      </Text>
    );
  if (fate.kind === "differs")
    return (
      <Text size="xs" className="shrink fault tight">
        Written, but reads back as {hex(fate.readBack, row.width)}. Still staged.
      </Text>
    );
  return (
    <Text size="xs" className="shrink fault tight" component="div">
      <b>Refused.</b> {fate.problem.detail}
      {fate.problem.way_out && !fate.problem.detail.includes(fate.problem.way_out) && <div>{fate.problem.way_out}</div>}
    </Text>
  );
}

function AppliedEntry({ applied, row, axis }: { applied: Applied; row: RegisterRow; axis: string }) {
  const { edit, written } = applied;
  return (
    <li className={`${css.diffEntry} pad-s box mb-4`} data-fate="done">
      <Title row={row} axis={axis}>
        <span className="inline gap-2 accent text-12">
          {written.verified === true && <IconCheck size={13} aria-hidden />}
          {proofOf(written)}
        </span>
      </Title>
      <div className="room row gap-8 text-12">
        <span className="hint mono anywhere">
          {edit.value !== null
            ? "value"
            : row.fields
                .filter((field) => field.name in edit.fields)
                .map((f) => f.name)
                .join(", ")}
        </span>
        <span className="num push right breaks">
          {readable(row.access) ? "reads" : "written"} {hex(written.raw, row.width)}
        </span>
      </div>
      {(written.note !== "" || written.verified === null) && (
        <Text size="xs" className="dim">
          {written.note || "The device changes it by itself, so a read-back proves nothing."}
        </Text>
      )}
    </li>
  );
}

function Title({ row, axis, children }: { row: RegisterRow; axis: string; children: ReactNode }) {
  return (
    <div className="row gap-8">
      <RegisterName name={row.name} strong />
      {row.alias !== "" && <span className="hint">{row.alias}</span>}
      {axis !== "" && <span className="hint">{axis}</span>}
      <span className="grow" />
      {children}
    </div>
  );
}

function Discard({ label, onClick }: { label: string; onClick: () => void }) {
  return (
    <ActionIcon size={20} aria-label={label} onClick={onClick}>
      <IconArrowBackUp size={13} />
    </ActionIcon>
  );
}
