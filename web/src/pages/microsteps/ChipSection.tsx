import { Button } from "@mantine/core";
import { IconDownload, IconUpload } from "@tabler/icons-react";
import type { UseMutationResult } from "@tanstack/react-query";
import type { ReactNode } from "react";
import type { Capability, Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { useWhoCan } from "../../lib/models";
import { ProblemAlert } from "../../lib/ProblemAlert";
import classes from "./Microsteps.module.css";
import { MotorRow } from "./MotorRow";
import type { Motor } from "./useMotor";

interface Props<T> {
  device: Device | undefined;
  motor: Motor;
  /** "table", "wave" */
  what: string;
  /** what who holds one can, where there is no device */
  needs: Capability;
  /** how the chip's is to the design, while a chip is there to ask */
  note: string;
  /** what to read; null while that is not known */
  onRead: (() => void) | null;
  /** what is to be sent; null where there is nothing, or nothing new */
  wanted: T | null;
  send: UseMutationResult<unknown, Error, T>;
  /** what came of it */
  children: ReactNode;
}

/** Into the chip and out of it, also while the motor runs: its position and velocity stand beside. */
export function ChipSection<T>({ device, motor, what, needs, note, onRead, wanted, send, children }: Props<T>) {
  const makers = useWhoCan(needs).map((title) => `a ${title}`);
  const error = send.error ?? motor.run.error ?? motor.stop.error;
  const why =
    device === undefined
      ? `No device: the design works without one; add ${makers.join(" or ")} under Connections to send it.`
      : motor.connected
        ? null
        : `${device.name} is not connected: the design stays, connect it under Connections to send it.`;
  return (
    <Card
      title="Chip"
      note={why ?? note}
      actions={
        <>
          <Button
            variant="default"
            leftSection={<IconDownload size={14} aria-hidden />}
            disabled={onRead === null}
            onClick={() => onRead?.()}
          >
            Read from chip
          </Button>
          <Button
            leftSection={<IconUpload size={14} aria-hidden />}
            disabled={!motor.connected || wanted === null}
            loading={send.isPending}
            onClick={() => wanted !== null && send.mutate(wanted)}
          >
            Send to chip
          </Button>
        </>
      }
    >
      <MotorRow motor={motor} />
      <p className={`hint m-0 mt-4 ${classes.outcome}`} aria-live="polite">
        {children}
      </p>
      {error !== null && (
        <ProblemAlert
          error={error}
          doing={send.error ? `Sending the ${what}` : motor.run.error ? "Running the motor" : "Stopping the axis"}
          onClose={() => {
            send.reset();
            motor.run.reset();
            motor.stop.reset();
          }}
        />
      )}
    </Card>
  );
}

/** " while the motor ran at 1 200 pps", or nothing at rest. */
export function whileRunning(motor: Motor): string {
  const live = motor.live.data;
  return live?.moving ? ` while the motor ran at ${fixed(live.velocity_pps, 0, "pps")}` : "";
}
