import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api } from "../../../api/client";
import type { RegisterRow } from "../../../lib/rows/bits";
import { type Key, keyOf } from "../../../lib/rows/staging";

/** What the EEPROM is known to hold: only a store or a restore tells. */
export interface Kept {
  value: number;
  at: number;
  how: "stored" | "restored";
}

export type EepromAction = "store" | "restore";

/** Copies single parameters between RAM and EEPROM, and remembers what that told of the EEPROM. */
export function useEeprom(device: string) {
  const queries = useQueryClient();
  const [kept, setKept] = useState<ReadonlyMap<Key, Kept>>(new Map());
  const copy = useMutation({
    mutationFn: async ({ row, action }: { row: RegisterRow; action: EepromAction }) => {
      const path = { path: { device, name: row.name }, query: row.axis === null ? {} : { axis: row.axis } };
      return api.POST(`/api/v1/devices/{device}/registers/{name}/${action}`, path);
    },
    onSuccess: (reading, { row, action }) =>
      setKept((now) =>
        new Map(now).set(keyOf(row), {
          value: reading.value,
          at: Date.now(),
          how: action === "store" ? "stored" : "restored",
        }),
      ),
    onSettled: () => queries.invalidateQueries({ queryKey: ["registers", device] }),
  });
  return {
    kept,
    error: copy.error,
    dismiss: copy.reset,
    /** the row whose copy is under way */
    busy: copy.isPending ? keyOf(copy.variables.row) : null,
    doing: copy.variables
      ? `${copy.variables.action === "store" ? "Storing" : "Restoring"} ${copy.variables.row.alias}`
      : "",
    run: (row: RegisterRow, action: EepromAction) => copy.mutate({ row, action }),
  };
}
