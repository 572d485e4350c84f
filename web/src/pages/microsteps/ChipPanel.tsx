import { Button } from "@mantine/core";
import { IconArrowsLeftRight, IconDownload, IconPlayerStop, IconUpload } from "@tabler/icons-react";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, unwrap } from "../../api/client";
import { motion } from "../../api/motion";
import type { Device } from "../../api/queries";
import { fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { Section } from "../../lib/Section";
import classes from "./Microsteps.module.css";
import { sameTable } from "./table";

interface Props {
  device: Device | undefined;
  axis: number;
  /** what the chip holds; null while that is not known */
  held: readonly number[] | null;
  values: readonly number[] | null;
  stale: boolean;
  onRead: () => void;
}

const LIVE_MS = 200;
const TURNS = 2;

/** Into the chip and out of it, also while the motor runs: its position and velocity stand beside. */
export function ChipPanel({ device, axis, held, values, stale, onRead }: Props) {
  const queries = useQueryClient();
  const id = device?.id ?? "";
  const connected = device?.state === "connected";
  const at = { device: id, axis };
  const live = useQuery({
    queryKey: ["axis", id, axis],
    queryFn: async ({ signal }) =>
      unwrap(await api.GET("/api/v1/devices/{device}/axes/{axis}", { params: { path: at }, signal })),
    enabled: connected,
    refetchInterval: LIVE_MS,
  });
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
      const running = live.data?.moving ? `, while the motor ran at ${fixed(live.data.velocity_pps)} pps` : "";
      const time = new Date().toLocaleTimeString();
      setSent(
        sameTable(answer.values, table)
          ? `All 64 values written and read back at ${time}${running}.`
          : `The chip reads back other values than were written at ${time}: see the differences in the curve.`,
      );
    },
  });
  const run = useMutation({
    mutationFn: async () => {
      const info = device?.axes[axis];
      const here = live.data?.position ?? 0;
      const way = TURNS * (info?.full_steps_per_rev ?? 200) * (info?.microsteps_per_full_step ?? 64);
      // towards zero, where a stage has its middle or its start: away from it there may be a switch
      return motion.shuttle(at, { first: here, second: here > 0 ? here - way : here + way, dwell_s: 0.2 });
    },
  });
  const stop = useMutation({
    mutationFn: async () => {
      await motion.stop(at, "ramp");
      await motion.endShuttle(at);
    },
  });

  const different = values && held ? values.filter((value, index) => value !== held[index]).length : null;
  const why =
    device === undefined
      ? "No device: the design works without one; add a TMC428 under Connections to send it."
      : connected
        ? null
        : `${device.name} is not connected: the design stays, connect it under Connections to send it.`;
  const state = live.data;
  const error = send.error ?? run.error ?? stop.error;

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
      <div className={classes.live}>
        <dl data-old={live.isError || !connected || undefined}>
          <div>
            <dt>position</dt>
            <dd className="num">{state ? `${fixed(state.position)} µsteps` : "–"}</dd>
          </div>
          <div>
            <dt>velocity</dt>
            <dd className="num">{state ? `${fixed(state.velocity_pps)} pps` : "–"}</dd>
          </div>
          <div>
            <dt>motor</dt>
            <dd>{state ? (state.moving ? "runs" : "at rest") : "–"}</dd>
          </div>
        </dl>
        <Button
          size="xs"
          variant="light"
          leftSection={<IconArrowsLeftRight size={14} aria-hidden />}
          disabled={!connected}
          loading={run.isPending}
          title={`${TURNS} turns there and back, until stopped`}
          onClick={() => run.mutate()}
        >
          Shuttle
        </Button>
        <Button
          size="xs"
          variant="default"
          leftSection={<IconPlayerStop size={14} aria-hidden />}
          disabled={!connected}
          onClick={() => stop.mutate()}
        >
          Stop
        </Button>
      </div>
      <p className={`${classes.hint} ${classes.outcome}`} aria-live="polite">
        {sent ?? "A table goes to the chip in 32 datagrams, also while the motor runs."}
      </p>
      {error !== null && (
        <ProblemAlert
          error={error}
          doing={send.error ? "Sending the table" : run.error ? "Running the motor" : "Stopping the axis"}
          onClose={() => {
            send.reset();
            run.reset();
            stop.reset();
          }}
        />
      )}
    </Section>
  );
}
