import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api } from "../../api/client";
import type { Device } from "../../api/queries";
import { timeOf } from "../../lib/time";
import { ChipSection, whileRunning } from "./ChipSection";
import { sameTable } from "./table";
import { useMotor } from "./useMotor";
import { tableKey } from "./useTable";

interface Props {
  device: Device | undefined;
  axis: number;
  /** what the chip holds; null while that is not known */
  held: readonly number[] | null;
  values: readonly number[] | null;
  stale: boolean;
  onRead: () => void;
}

/** The quarter wave of 64 values into the chip and out of it. */
export function ChipPanel({ device, axis, held, values, stale, onRead }: Props) {
  const queries = useQueryClient();
  const id = device?.id ?? "";
  const motor = useMotor(device, axis);
  const [sent, setSent] = useState<string | null>(null);

  const send = useMutation({
    mutationFn: async (table: readonly number[]) => {
      const answer = await api.PUT("/api/v1/devices/{device}/microstep-table", {
        path: { device: id },
        body: { values: [...table] },
      });
      queries.setQueryData(tableKey(id), answer);
      const time = timeOf(Date.now());
      setSent(
        sameTable(answer.values, table)
          ? `All 64 values written and read back at ${time}${whileRunning(motor)}.`
          : `The chip reads back other values than were written at ${time}: see the differences in the curve.`,
      );
    },
  });
  const different = values && held ? values.filter((value, index) => value !== held[index]).length : null;
  const note =
    different === null ? "" : different === 0 ? "holds this table" : `${different} of 64 values differ from the chip's`;
  return (
    <ChipSection
      device={device}
      motor={motor}
      what="table"
      needs="microsteps.ram"
      note={note}
      onRead={held && onRead}
      wanted={different === 0 || stale ? null : values}
      send={send}
    >
      {sent ?? "A table goes to the chip in 32 datagrams, also while the motor runs."}
    </ChipSection>
  );
}
