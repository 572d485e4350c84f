import { Button } from "@mantine/core";
import { IconArrowsLeftRight, IconCheck, IconPlayerPlay, IconUpload, IconX } from "@tabler/icons-react";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { memo, useState } from "react";
import { api, type Schemas, unwrap } from "../../api/client";
import { motion } from "../../api/motion";
import type { Device } from "../../api/queries";
import { fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { Section } from "../../lib/Section";
import { type ChipRamp, type Difference, shownValue, waits, writesFor } from "./chip";
import type { Options } from "./design";
import classes from "./sramp.module.css";

interface Props {
  device: Device | undefined;
  axis: number;
  connected: boolean;
  chip: ChipRamp | null;
  /** null while the registers of the design are not known */
  differences: Difference[] | null;
  options: Options;
  vmax: number;
  distance: number;
}

const DWELL_S = 0.4;

/** Chip against design, one click to the chip, and moves with it. */
export const SendSection = memo(function SendSection({
  device,
  axis,
  connected,
  chip,
  differences,
  options,
  vmax,
  distance,
}: Props) {
  const queries = useQueryClient();
  const [result, setResult] = useState<{ sent: string[]; answer: Schemas["RegisterBatchResult"] } | null>(null);
  const id = device?.id ?? "";
  const at = { device: id, axis };
  const velocity = options.mode === "velocity";
  const changed = differences?.filter((row) => row.from !== row.to) ?? [];

  async function write(): Promise<boolean> {
    const writes = writesFor(changed, axis);
    if (writes.length === 0) return true;
    const answer = unwrap(
      await api.POST("/api/v1/devices/{device}/registers", { params: { path: { device: id } }, body: { writes } }),
    );
    setResult({ sent: writes.map((entry) => entry.name), answer });
    void queries.invalidateQueries({ queryKey: ["registers", id] });
    void queries.invalidateQueries({ queryKey: ["devices"] });
    return answer.failed === null && answer.done.every((entry) => entry.verified !== false);
  }

  const send = useMutation({ mutationFn: write });
  const move = useMutation({
    mutationFn: async () => {
      if (!(await write())) return null;
      if (velocity) {
        const started = await motion.rotate(at, { velocity: distance < 0 ? -vmax : vmax, unit: "pps" });
        return {
          text: `Rotates at ${fixed(started.velocity_pps)} pps until it is stopped.`,
          warnings: started.warnings,
        };
      }
      const started = await motion.move(at, { target: distance, relative: true, unit: "microsteps" });
      return {
        text: `Moves from ${fixed(started.from_position)} to ${fixed(started.target_position)} µsteps.`,
        warnings: started.warnings,
      };
    },
  });
  const shuttle = useQuery({
    queryKey: ["shuttle", id, axis],
    queryFn: async () =>
      unwrap(await api.GET("/api/v1/devices/{device}/axes/{axis}/shuttle", { params: { path: at } })),
    enabled: connected,
    refetchInterval: 1000,
  });
  const runs = shuttle.data?.running === true;
  const back = useMutation({
    mutationFn: async () => {
      if (runs) await motion.endShuttle(at);
      else if (await write()) {
        const state = unwrap(await api.GET("/api/v1/devices/{device}/axes/{axis}", { params: { path: at } }));
        const first = Math.round(state.position);
        await motion.shuttle(at, { first: first + distance, second: first, dwell_s: DWELL_S });
      }
    },
    onSettled: () => queries.invalidateQueries({ queryKey: ["shuttle", id, axis] }),
  });
  const stop = useMutation({ mutationFn: async () => motion.stop(at, "ramp") });

  const busy = send.isPending || move.isPending || back.isPending;
  const why =
    device === undefined
      ? "No device: add a TMC4361 under Connections to send this design."
      : !connected
        ? `${device.name} is not connected: the design stays, connect it under Connections to send.`
        : differences === null
          ? "The registers are not known yet, so there is nothing to send."
          : null;

  return (
    <Section
      title="To the chip"
      note={
        why === null
          ? changed.length === 0
            ? "the chip holds this design"
            : `${changed.length} ${changed.length === 1 ? "value differs" : "values differ"}`
          : ""
      }
      actions={
        <>
          <Button
            size="xs"
            leftSection={<IconUpload size={14} aria-hidden />}
            disabled={why !== null || changed.length === 0 || busy}
            loading={send.isPending}
            onClick={() => send.mutate()}
          >
            Send
          </Button>
          <Button
            size="xs"
            variant="light"
            leftSection={<IconPlayerPlay size={14} aria-hidden />}
            disabled={why !== null || busy || runs}
            loading={move.isPending}
            onClick={() => move.mutate()}
          >
            {velocity ? "Rotate with it" : "Move with it"}
          </Button>
          {(!velocity || runs) && (
            <Button
              size="xs"
              variant="light"
              leftSection={<IconArrowsLeftRight size={14} aria-hidden />}
              disabled={why !== null || (busy && !runs)}
              loading={back.isPending}
              onClick={() => back.mutate()}
            >
              {runs ? "End there and back" : "There and back"}
            </Button>
          )}
          <Button size="xs" variant="default" disabled={!connected} onClick={() => stop.mutate()}>
            Stop axis
          </Button>
        </>
      }
    >
      {why !== null && <p className={classes.hint}>{why}</p>}
      {why === null && <Cautions chip={chip} changed={changed} />}
      {differences && device && (
        <table className={classes.diff}>
          <thead>
            <tr>
              <th scope="col">register</th>
              <th scope="col">chip</th>
              <th scope="col">design</th>
              <th scope="col">read back</th>
            </tr>
          </thead>
          <tbody>
            {differences.map((row) => (
              <tr key={row.label} data-changed={row.from !== row.to || undefined}>
                <th scope="row">{row.label}</th>
                <td className="num">{shownValue(row, row.from, fixed)}</td>
                <td className="num">{shownValue(row, row.to, fixed)}</td>
                <td>{outcome(row, result)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      <div aria-live="polite">
        {result?.answer.failed && <ProblemAlert error={result.answer.failed} doing="Sending the design" />}
        {send.isError && <ProblemAlert error={send.error} doing="Sending the design" onClose={send.reset} />}
        {move.isError && <ProblemAlert error={move.error} doing="Moving" onClose={move.reset} />}
        {back.isError && <ProblemAlert error={back.error} doing="Moving there and back" onClose={back.reset} />}
        {stop.isError && <ProblemAlert error={stop.error} doing="Stopping the axis" onClose={stop.reset} />}
        {move.data && !runs && (
          <p className={classes.hint}>
            {move.data.text} {move.data.warnings.join(" ")}
          </p>
        )}
        {runs && <p className={classes.hint}>Moves there and back until it is ended or the axis is stopped.</p>}
      </div>
    </Section>
  );
});

/** What a write would set going, or mean otherwise than it says (002, 8.2.2). */
function Cautions({ chip, changed }: { chip: ChipRamp | null; changed: readonly Difference[] }) {
  if (chip === null) return null;
  const get = (name: string) => chip.get(name) ?? 0;
  const writes = (label: string) => changed.some((row) => row.label === label);
  const positioning = get("OPERATION_MODE") === 1;
  const away = get("XTARGET") - get("XACTUAL");
  const moves = get("VACTUAL") !== 0;
  const notes = [
    positioning && away !== 0 && get("VMAX") === 0 && writes("VMAX")
      ? `VMAX is 0 on the chip and the target is ${fixed(away)} µsteps away: the motor starts as soon as VMAX is written.`
      : null,
    waits(chip) && writes("VMAX")
      ? "The chip stands in velocity mode: it is told to hold its place before VMAX is written, which would turn it."
      : null,
    !positioning && !waits(chip) && writes("VMAX")
      ? "The chip is in velocity mode: the motor turns at VMAX as soon as it is written. A move puts it in positioning mode."
      : null,
    moves && changed.some((row) => row.register === "GENERAL_CONF")
      ? "The motor moves: with other units its ramp changes until all values are written."
      : null,
    moves && positioning && changed.some((row) => row.register !== "GENERAL_CONF" && row.label !== "VMAX")
      ? "The motor moves: other ramp values than VMAX may take it beyond its target for a while."
      : null,
  ].filter((note) => note !== null);
  return notes.map((note) => (
    <p key={note} className={classes.caution}>
      {note}
    </p>
  ));
}

/** How the register of a row fared in the last batch. */
function outcome(row: Difference, result: { sent: string[]; answer: Schemas["RegisterBatchResult"] } | null) {
  const index = result?.sent.indexOf(row.register) ?? -1;
  if (!result || index < 0) return <span className={classes.dim}>–</span>;
  const written = result.answer.done[index];
  if (!written) {
    const failed = index === result.answer.done.length && result.answer.failed !== null;
    return <span className={classes.fault}>{failed ? "refused" : "not tried"}</span>;
  }
  const value = row.field === null ? written.value : written.fields[row.field];
  const good = written.verified !== false;
  return (
    <span className={good ? classes.good : classes.fault}>
      {good ? <IconCheck size={12} aria-hidden /> : <IconX size={12} aria-hidden />}
      <span className="num"> {shownValue(row, value ?? null, fixed)}</span>
    </span>
  );
}
