import { useMutation } from "@tanstack/react-query";
import { useState } from "react";
import { api, type Schemas } from "../../../api/client";
import type { RegisterRow } from "../../../lib/rows/bits";
import { type Key, keyOf } from "../../../lib/rows/staging";

export interface Asked {
  reading: Schemas["RegisterReading"];
  at: number;
}

/** Reads what nobody reads by itself: a parameter that the reading clears. */
export function useRead(device: string) {
  const [answers, setAnswers] = useState<ReadonlyMap<Key, Asked>>(new Map());
  const read = useMutation({
    mutationFn: (row: RegisterRow) =>
      api.GET("/api/v1/devices/{device}/registers/{name}", {
        path: { device, name: row.name },
        query: row.axis === null ? {} : { axis: row.axis },
      }),
    onSuccess: (reading, row) => setAnswers((now) => new Map(now).set(keyOf(row), { reading, at: Date.now() })),
  });
  return {
    answers,
    error: read.error,
    dismiss: read.reset,
    busy: read.isPending ? keyOf(read.variables) : null,
    run: (row: RegisterRow) => read.mutate(row),
  };
}
