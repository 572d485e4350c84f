import { Button } from "@mantine/core";
import { IconDownload, IconUpload } from "@tabler/icons-react";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, type Schemas, unwrap } from "../../../api/client";
import type { Device } from "../../../api/queries";
import { fixed } from "../../../lib/format";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { Section } from "../../../lib/Section";
import { MotorRow } from "../MotorRow";
import { useMotor } from "../useMotor";
import classes from "./Mslut.module.css";
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
        unwrap(
          await api.PUT("/api/v1/devices/{device}/microstep-table", {
            params: { path: { device: id } },
            body: { registers: wordsOf(wanted.registers), mirror: wanted.mirror },
          }),
        ),
      );
      queries.setQueryData(["microstep-table", id], answer);
      if (!answer) return;
      const running = motor.live.data?.moving
        ? ` while the motor ran at ${fixed(motor.live.data.velocity_pps)} pps`
        : "";
      const time = new Date().toLocaleTimeString();
      setSent(
        sameRegisters(answer.registers, wanted.registers)
          ? `Ten registers written at ${time}${running}.`
          : `The chip holds other registers than were written at ${time}: they are marked in the list.`,
      );
    },
  });

  const same = sameWave(table, held);
  const why =
    device === undefined
      ? "No device: the design works without one; add a TMC4361 under Connections to send it."
      : motor.connected
        ? null
        : `${device.name} is not connected: the design stays, connect it under Connections to send it.`;
  const error = send.error ?? motor.run.error ?? motor.stop.error;

  return (
    <Section
      title="Chip"
      note={
        why ??
        (held === null
          ? ""
          : same
            ? "holds this wave"
            : table === null
              ? "this wave cannot be encoded"
              : `${different(table, held)} of 256 values differ from the chip's`)
      }
      actions={
        <>
          <Button
            size="xs"
            variant="default"
            leftSection={<IconDownload size={14} aria-hidden />}
            disabled={held === null}
            onClick={onRead}
          >
            Read from chip
          </Button>
          <Button
            size="xs"
            leftSection={<IconUpload size={14} aria-hidden />}
            disabled={!motor.connected || table === null || stale || (same && held?.written === true)}
            loading={send.isPending}
            onClick={() => table && send.mutate(table)}
          >
            Send to chip
          </Button>
        </>
      }
    >
      <MotorRow motor={motor} />
      <p className={`${classes.hint} ${classes.outcome}`} aria-live="polite">
        {sent !== null && `${sent} `}
        {held === null
          ? "A wave goes to the chip in ten registers, which cannot be read back: its currents show what it holds."
          : `${held.written ? "" : "Nothing was written yet: the power-on wave is taken to be there. "}${
              seen.places > 4 ? turned(seen) : shown(held)
            }`}
      </p>
      {error !== null && (
        <ProblemAlert
          error={error}
          doing={send.error ? "Sending the wave" : motor.run.error ? "Running the motor" : "Stopping the axis"}
          onClose={() => {
            send.reset();
            motor.run.reset();
            motor.stop.reset();
          }}
        />
      )}
    </Section>
  );
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
