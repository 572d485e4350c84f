import { useMemo, useState } from "react";
import { useAddressText } from "../address";
import type { FieldRow, RegisterRow } from "./bits";
import { type Key, keyOf, stage } from "./staging";
import { discardStaged, editStaged } from "./store";

/** What a row may ask of its page. Stable, so that rows render only for their own sake. */
export interface RowActions {
  select: (key: Key) => void;
  toggle: (key: Key, open?: boolean) => void;
  edit: (key: Key | null) => void;
  stage: (row: RegisterRow, field: FieldRow | null, value: number, chip: number | null) => void;
  unstage: (key: Key, field?: string) => void;
}

/** Which rows are open, in editing, and selected; the actions stay the same object as long as the device does. */
export function useRowState(device: string) {
  const [open, setOpen] = useState<ReadonlySet<Key>>(new Set());
  const [editing, setEditing] = useState<Key | null>(null);
  const [selected, select] = useAddressText("reg");
  const actions = useMemo<RowActions>(
    () => ({
      select,
      toggle: (key, wanted) =>
        setOpen((now) => {
          const next = new Set(now);
          if (wanted ?? !next.has(key)) next.add(key);
          else next.delete(key);
          return next;
        }),
      edit: setEditing,
      stage: (row, field, value, chip) =>
        editStaged(
          device,
          `Stage ${field?.name ?? row.name} ${value}`,
          (edits) => stage(edits, row, field, value, chip),
          `${keyOf(row)} ${field?.name ?? ""}`,
        ),
      unstage: (key, field) => discardStaged(device, key, field),
    }),
    [device, select],
  );
  return { open, editing, selected: selected === "" ? null : selected, actions };
}
