import { useMemo } from "react";
import type { Device } from "../../api/queries";
import { type FieldRow, type RegisterRow, readable, toSigned, unpackField } from "./bits";
import { countChanges, type Edit, type Key, keyOf, stage, stagedRaw } from "./staging";
import { discardStaged, editStaged, useStaged } from "./store";
import { useApply } from "./useApply";
import { useRegisters } from "./useRegisters";
import { useWritten } from "./written";

/**
 * Where a value comes from: read from the chip just now, or what was last written to a register that cannot be read, by
 * the server's memory, which a reset of the chip clears, or else by this browser's.
 */
export type Origin = "read" | "written" | "unknown";

export interface Spot {
  row: RegisterRow;
  /** null for a register as a whole */
  field: FieldRow | null;
}

/**
 * Some registers of a chip for a page about one subject: values by name, and edits that wait with those of the registers
 * page. A register that has another name under a condition is read by its plain name.
 */
export function useChipRows(device: Device | undefined, axis: number, groups: readonly string[]) {
  const id = device?.id ?? "";
  const live = useRegisters(device, false, groups, true);
  const staged = useStaged(id);
  const apply = useApply(id);
  const written = useWritten(id);
  const rows = live.catalog.data?.rows;
  const byName = useMemo(() => {
    const found = new Map<string, RegisterRow>();
    for (const row of rows ?? []) if (row.axis === axis || row.axis === null) found.set(row.name, row);
    return found;
  }, [rows, axis]);
  const byKey = useMemo(() => new Map<Key, RegisterRow>((rows ?? []).map((row) => [keyOf(row), row])), [rows]);
  // one address may be read as one register and written as another
  const { rawAt, keptAt } = useMemo(() => {
    const found = { rawAt: new Map<number, number>(), keptAt: new Map<number, number>() };
    for (const { kept, address, raw } of live.readings.data ?? [])
      (kept ? found.keptAt : found.rawAt).set(address, raw);
    return found;
  }, [live.readings.data]);

  function spot(register: string, field?: string): Spot | null {
    const row = byName.get(register);
    if (row === undefined) return null;
    if (field === undefined) return { row, field: null };
    const part = row.fields.find((candidate) => candidate.name === field);
    return part ? { row, field: part } : null;
  }
  /** the word that the chip holds as far as is known */
  function word(row: RegisterRow): number | null {
    const { address } = row;
    const raw = readable(row.access) ? rawAt.get(address) : (keptAt.get(address) ?? written[String(address)]);
    return raw ?? null;
  }
  function origin(register: string): Origin {
    const row = byName.get(register);
    if (row === undefined || word(row) === null) return "unknown";
    return readable(row.access) ? "read" : "written";
  }
  const valueIn = (at: Spot, raw: number): number =>
    at.field ? unpackField(raw, at.field) : at.row.signed ? toSigned(raw, at.row.width) : raw;
  const editOf = (row: RegisterRow) => staged.edits.find((edit) => keyOf(edit) === keyOf(row));
  function held(register: string, field?: string): number | null {
    const at = spot(register, field);
    const raw = at === null ? null : word(at.row);
    return at === null || raw === null ? null : valueIn(at, raw);
  }
  function isStaged(register: string, field?: string): boolean {
    const at = spot(register, field);
    const edit = at && editOf(at.row);
    if (!edit) return false;
    return at.field === null ? true : edit.value !== null || at.field.name in edit.fields;
  }
  function planned(register: string, field?: string): number | null {
    const at = spot(register, field);
    if (at === null) return null;
    const edit = editOf(at.row);
    if (!edit || !isStaged(register, field)) return held(register, field);
    return valueIn(at, stagedRaw(edit, at.row, word(at.row)));
  }
  function put(register: string, field: string | undefined, value: number): void {
    const at = spot(register, field);
    if (at === null) return;
    const { row } = at;
    const raw = word(row);
    const name = at.field?.name ?? row.name;
    const staging = (now: readonly Edit[]) => {
      let edits = stage(now, row, at.field, value, readable(row.access) ? raw : null);
      // Of a word that cannot be read the chip keeps nothing: all its fields are written together.
      if (at.field !== null && !readable(row.access)) {
        const before = now.find((edit) => keyOf(edit) === keyOf(row));
        for (const other of row.fields) {
          if (other === at.field || other.when || (before && other.name in before.fields)) continue;
          edits = stage(edits, row, other, unpackField(raw ?? row.reset ?? 0, other), null);
        }
      }
      return edits;
    };
    editStaged(id, `Stage ${name} ${value}`, staging, `${keyOf(row)} ${name}`);
  }

  return {
    live,
    known: rows !== undefined,
    staged,
    count: countChanges(staged.edits),
    rows: byKey,
    apply,
    spot,
    held,
    planned,
    isStaged,
    origin,
    put,
    discard: (key: Key | null, field?: string) => discardStaged(id, key, field),
  };
}

export type ChipRows = ReturnType<typeof useChipRows>;
