import { Button } from "@mantine/core";
import { IconDownload, IconUpload } from "@tabler/icons-react";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, unwrap } from "../../api/client";
import type { Device } from "../../api/queries";
import { fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { Section } from "../../lib/Section";
import classes from "./Microsteps.module.css";
import { MotorRow } from "./MotorRow";
import { sameTable } from "./table";
import { useMotor } from "./useMotor";

interface Props {
  device: Device | undefined;
  axis: number;
  /** what the chip holds; null while that is not known */
  held: readonly number[] | null;
  values: readonly number[] | null;
  stale: boolean;
  onRead: () => void;
}

/** Into the chip and out of it, also while the motor runs: its position and velocity stand beside. */
export function ChipPanel({ device, axis, held, values, stale, onRead }: Props) {
  const queries = useQueryClient();
  const id = device?.id ?? "";
  const connected = device?.state === "connected";
  const motor = useMotor(device, axis);
  const [sent, setSent] = useState<string | null>(null);

  const send = useMutation({
    mutationFn: async (table: readonly number[]) => {
      const answer = unwrap(
        await api.PUT("/api/v1/devices/{device}/microstep-table", {
          params: { path: { device: id } },
          body: { values: [...table] },
        }),
      );
      queries.setQueryData(["microstep-table", id], answer);
      const running = motor.live.data?.moving
        ? `, while the motor ran at ${fixed(motor.live.data.velocity_pps)} pps`
        : "";
      const time = new Date().toLocaleTimeString();
      setSent(
        sameTable(answer.values, table)
          ? `All 64 values written and read back at ${time}${running}.`
          : `The chip reads back other values than were written at ${time}: see the differences in the curve.`,
      );
    },
  });
  const different = values && held ? values.filter((value, index) => value !== held[index]).length : null;
  const why =
    device === undefined
      ? "No device: the design works without one; add a TMC428 under Connections to send it."
      : connected
        ? null
        : `${device.name} is not connected: the design stays, connect it under Connections to send it.`;
  const error = send.error ?? motor.run.error ?? motor.stop.error;

  return (
    <Section
      title="Chip"
      note={
        why ??
        (different === null
          ? ""
          : different === 0
            ? "holds this table"
            : `${different} of 64 values differ from the chip's`)
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
            disabled={!connected || values === null || different === 0 || stale}
            loading={send.isPending}
            onClick={() => values && send.mutate(values)}
          >
            Send to chip
          </Button>
        </>
      }
    >
      <MotorRow motor={motor} />
      <p className={`${classes.hint} ${classes.outcome}`} aria-live="polite">
        {sent ?? "A table goes to the chip in 32 datagrams, also while the motor runs."}
      </p>
      {error !== null && (
        <ProblemAlert
          error={error}
          doing={send.error ? "Sending the table" : motor.run.error ? "Running the motor" : "Stopping the axis"}
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
