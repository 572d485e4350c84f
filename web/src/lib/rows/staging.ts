import type { Problem, Schemas } from "../../api/client";
import { acts, type FieldRow, packField, type RegisterRow, toRaw, unpackField } from "./bits";

type Written = Schemas["RegisterWritten"];
type BatchItem = Schemas["RegisterBatchItem"];
type BatchResult = Schemas["RegisterBatchResult"];

/** How a staged edit fared when it was last sent. */
export type Fate =
  | { kind: "refused"; problem: Problem }
  | { kind: "differs"; readBack: number }
  | { kind: "not tried" };

/** A change to one register that waits for Apply: the whole value, or of a packed register some fields. */
export interface Edit {
  name: string;
  axis: number | null;
  value: number | null;
  fields: Record<string, number>;
  /** What the chip held when the edit began; null where it was not known or cannot be read. */
  base: number | null;
  fate: Fate | null;
}

/** One line of the diff. */
export interface Change {
  /** The field; null for a register without fields. */
  field: FieldRow | null;
  /** What the chip holds now, as a value; null where it is not known. */
  from: number | null;
  to: number;
}

export type Key = string;

export function keyOf(row: { name: string; axis: number | null }): Key {
  return `${row.axis ?? "-"}/${row.name}`;
}

/** A register's edits with one more: `field` null stages the whole value. An edit that undoes itself is gone. */
export function stage(
  edits: readonly Edit[],
  row: RegisterRow,
  field: FieldRow | null,
  value: number,
  chip: number | null,
): Edit[] {
  const key = keyOf(row);
  const old = edits.find((edit) => keyOf(edit) === key);
  const edit: Edit = {
    name: row.name,
    axis: row.axis,
    value: field ? null : value,
    fields: field ? { ...old?.fields, [field.name]: value } : {},
    base: old ? old.base : chip,
    fate: null,
  };
  if (chip !== null) {
    if (field) {
      if (!acts(field) && unpackField(chip, field) === value) delete edit.fields[field.name];
    } else if (!acts(row) && toRaw(value, row.width) === chip) {
      edit.value = null;
    }
  }
  return replace(edits, key, isEmpty(edit) ? null : edit);
}

/** Without the edit of that register, or of one field of it. */
export function unstage(edits: readonly Edit[], key: Key, field?: string): Edit[] {
  const old = edits.find((edit) => keyOf(edit) === key);
  if (!old) return [...edits];
  if (field === undefined) return replace(edits, key, null);
  const fields = { ...old.fields };
  delete fields[field];
  const edit = { ...old, fields, fate: null };
  return replace(edits, key, isEmpty(edit) ? null : edit);
}

function isEmpty(edit: Edit): boolean {
  return edit.value === null && Object.keys(edit.fields).length === 0;
}

function replace(edits: readonly Edit[], key: Key, edit: Edit | null): Edit[] {
  const at = edits.findIndex((candidate) => keyOf(candidate) === key);
  if (at < 0) return edit ? [...edits, edit] : [...edits];
  return [...edits.slice(0, at), ...(edit ? [edit] : []), ...edits.slice(at + 1)];
}

/** The word that the chip will hold, as far as is known. */
export function stagedRaw(edit: Edit, row: RegisterRow, chip: number | null): number {
  if (edit.value !== null) return toRaw(edit.value, row.width);
  let word = chip ?? 0;
  for (const field of row.fields) {
    const value = edit.fields[field.name];
    // A clear bit of which nothing is staged is written as 0, so that only the chosen flags are cleared.
    if (value !== undefined) word = packField(word, field, value);
  }
  return word;
}

/** The lines of the diff, in the order of the register's fields. */
export function changes(edit: Edit, row: RegisterRow, chip: number | null): Change[] {
  if (edit.value !== null) {
    const from =
      chip === null ? null : row.signed ? unpackField(chip, { lsb: 0, width: row.width, signed: true }) : chip;
    return [{ field: null, from, to: edit.value }];
  }
  return row.fields.flatMap((field) => {
    const to = edit.fields[field.name];
    return to === undefined ? [] : [{ field, from: chip === null ? null : unpackField(chip, field), to }];
  });
}

export function countChanges(edits: readonly Edit[]): number {
  return edits.reduce((sum, edit) => sum + (edit.value !== null ? 1 : Object.keys(edit.fields).length), 0);
}

/** What goes to `POST /devices/{device}/registers`, in the order of staging. */
export function batchOf(edits: readonly Edit[]): BatchItem[] {
  return edits.map((edit) => ({
    name: edit.name,
    axis: edit.axis,
    ...(edit.value !== null ? { value: edit.value } : { fields: edit.fields }),
  }));
}

export interface Applied {
  edit: Edit;
  written: Written;
}

/**
 * Who of `sent` got through. `left` takes the place of what was sent: nothing that failed is lost. An answer that
 * reads back as something else (`verified` false) counts as failed.
 */
export function settle(sent: readonly Edit[], result: BatchResult): { applied: Applied[]; left: Edit[] } {
  const applied: Applied[] = [];
  const left: Edit[] = [];
  sent.forEach((edit, index) => {
    const written = result.done[index];
    if (written && written.verified !== false) applied.push({ edit, written });
    else if (written) left.push({ ...edit, fate: { kind: "differs", readBack: written.raw } });
    else if (index === result.done.length && result.failed)
      left.push({ ...edit, fate: { kind: "refused", problem: result.failed } });
    else left.push({ ...edit, fate: { kind: "not tried" } });
  });
  return { applied, left };
}

/** What is staged after `settle`: edits that changed while the answer was on its way stay as they are now. */
export function merge(now: readonly Edit[], sent: readonly Edit[], left: readonly Edit[]): Edit[] {
  return now.flatMap((edit) => {
    const before = sent.find((candidate) => keyOf(candidate) === keyOf(edit));
    if (before !== edit) return [edit];
    return left.filter((candidate) => keyOf(candidate) === keyOf(edit));
  });
}
