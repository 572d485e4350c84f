import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, type Schemas } from "../../../api/client";
import type { Device } from "../../../api/queries";
import { fixed } from "../../../lib/format";
import { timeOf } from "../../../lib/time";
import { ChipSection, whileRunning } from "../ChipSection";
import { useMotor } from "../useMotor";
import { tableKey } from "../useTable";
import { POSITIONS, sameRegisters, sameWave, type Table, wordsOf } from "./wave";

export type Held = Schemas["MslutHeld"];

interface Props {
  device: Device | undefined;
  axis: number;
  /** what the chip holds; null while that is not known */
  held: Held | null;
  /** how much of its wave the chip has shown, and how much of that was not as it should be */
  seen: { places: number; wrong: number };
  /** the encoded design; null while it cannot be encoded */
  table: Table | null;
  stale: boolean;
  onRead: () => void;
}

/** The table of a device that is known to have an MSLUT. */
export function asHeld(answer: Schemas["MicrostepTable"] | Held): Held | null {
  return "registers" in answer ? answer : null;
}

/** Into the chip and out of it, also while the motor runs. What cannot be read back is checked by its currents. */
export function Chip({ device, axis, held, seen, table, stale, onRead }: Props) {
  const queries = useQueryClient();
  const id = device?.id ?? "";
  const motor = useMotor(device, axis);
  const [sent, setSent] = useState<string | null>(null);

  const send = useMutation({
    mutationFn: async (wanted: Table) => {
      const answer = asHeld(
        await api.PUT("/api/v1/devices/{device}/microstep-table", {
          path: { device: id },
          body: { registers: wordsOf(wanted.registers), mirror: wanted.mirror },
        }),
      );
      queries.setQueryData(tableKey(id), answer);
      if (!answer) return;
      const time = timeOf(Date.now());
      setSent(
        sameRegisters(answer.registers, wanted.registers)
          ? `Ten registers written at ${time}${whileRunning(motor)}.`
          : `The chip holds other registers than were written at ${time}: they are marked in the list.`,
      );
    },
  });

  const same = sameWave(table, held);
  const note =
    held === null
      ? ""
      : same
        ? sameNote(table, held)
        : table === null
          ? "this wave cannot be encoded"
          : `${different(table, held)} of 256 values differ from the chip's`;
  return (
    <ChipSection
      device={device}
      motor={motor}
      what="wave"
      needs="microsteps.mslut"
      note={note}
      onRead={held && onRead}
      wanted={stale || (same && held?.written === true) ? null : table}
      send={send}
    >
      {sent !== null && `${sent} `}
      {held === null
        ? "A wave goes to the chip in ten registers, which cannot be read back: its currents show what it holds."
        : `${held.written ? "" : "Nothing was written yet: the power-on wave is taken to be there. "}${
            seen.places > 4 ? turned(seen) : shown(held)
          }`}
    </ChipSection>
  );
}

/** The same values may lie in other registers: then the design's own were not written, and it says so. */
export function sameNote(table: Pick<Table, "registers"> | null, held: Pick<Held, "registers" | "written">): string {
  const others = table?.registers.filter((row, at) => row.value !== held.registers[at]?.value).length ?? 0;
  if (others > 0) return `the same values in other registers: ${others} of ${held.registers.length} differ`;
  return held.written ? "this wave was written" : "this wave is taken to be there";
}

function different(table: Table, held: Table): number {
  return table.values.filter((value, index) => value !== held.values[index]).length;
}

function shown(held: Held): string {
  const at = `At position ${held.position} the chip shows ${fixed(held.current_a)} and ${fixed(held.current_b)}`;
  return held.agrees
    ? `${at}: what the table has there.`
    : `${at}; the table has ${fixed(held.current_a_expected)} and ${fixed(held.current_b_expected)} there.`;
}

function turned({ places, wrong }: { places: number; wrong: number }): string {
  const seen = `The motor has shown ${places} of ${POSITIONS} positions`;
  return wrong === 0
    ? `${seen}, all as the table has them.`
    : `${seen}; ${wrong} samples are not as the table has them.`;
}
