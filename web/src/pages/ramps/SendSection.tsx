import { Button } from "@mantine/core";
import { IconCheck, IconPlayerPlay, IconUpload, IconX } from "@tabler/icons-react";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, type Schemas, unwrap } from "../../api/client";
import { fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { Section } from "../../lib/Section";
import { type ChipRamp, type Difference, type RampMode, writesFor } from "./design";
import classes from "./Ramps.module.css";

interface Props {
  device: Schemas["DeviceInfo"] | undefined;
  axis: number;
  connected: boolean;
  chip: ChipRamp | null;
  /** null while there is no pair, so nothing complete to send */
  differences: Difference[] | null;
  noPair: boolean;
  mode: RampMode;
  vMax: number;
  distance: number;
}

const MODES = ["ramp", "soft", "velocity", "hold"];

function shown(row: Difference, value: number | null): string {
  return row.key === "mode" && value !== null ? (MODES[value] ?? fixed(value)) : fixed(value);
}

/** Chip against design, one click to the chip, and a move with it. */
export function SendSection(props: Props) {
  const { device, axis, connected, chip, differences, noPair, mode, vMax, distance } = props;
  const queries = useQueryClient();
  const [result, setResult] = useState<{ sent: string[]; answer: Schemas["RegisterBatchResult"] } | null>(null);
  const id = device?.id ?? "";
  const path = { device: id, axis };

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
      if (mode === "velocity") {
        const velocity = distance < 0 ? -vMax : vMax;
        const answer = await api.POST("/api/v1/devices/{device}/axes/{axis}/rotate", {
          params: { path },
          body: { velocity, unit: "chip" },
        });
        const started = unwrap(answer);
        return {
          text: `Rotates at ${fixed(started.velocity_pps)} pps until it is stopped.`,
          warnings: started.warnings,
        };
      }
      const answer = await api.POST("/api/v1/devices/{device}/axes/{axis}/move", {
        params: { path },
        body: { target: distance, relative: true, unit: "microsteps" },
      });
      const started = unwrap(answer);
      return {
        text: `Moves from ${fixed(started.from_position)} to ${fixed(started.target_position)} µsteps.`,
        warnings: started.warnings,
      };
    },
  });
  const stop = useMutation({
    mutationFn: async () =>
      unwrap(await api.POST("/api/v1/devices/{device}/axes/{axis}/stop", { params: { path }, body: { mode: "ramp" } })),
  });

  const busy = send.isPending || move.isPending;
  const why =
    device === undefined
      ? "No device: add one under Connections to send this design."
      : !connected
        ? `${device.name} is not connected: the design stays, connect it under Connections to send.`
        : differences === null
          ? noPair
            ? "No pair represents p, so there is nothing complete to send."
            : "The pair is not known yet, so there is nothing complete to send."
          : null;
  const starts =
    chip !== null &&
    chip.design.v_max === 0 &&
    chip.mode <= 1 &&
    chip.position !== null &&
    chip.target !== null &&
    chip.position !== chip.target &&
    changed.some((row) => row.key === "v_max");

  return (
    <Section
      title="To the chip"
      note={
        why === null ? (changed.length === 0 ? "the chip holds this design" : `${changed.length} values differ`) : ""
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
            disabled={why !== null || busy}
            loading={move.isPending}
            onClick={() => move.mutate()}
          >
            {mode === "velocity" ? "Rotate with it" : "Move with it"}
          </Button>
          <Button size="xs" variant="default" disabled={!connected} onClick={() => stop.mutate()}>
            Stop axis
          </Button>
        </>
      }
    >
      {why !== null && <p className={classes.hint}>{why}</p>}
      {starts && (
        <p className={classes.caution}>
          v_max is 0 on the chip and the target is {fixed((chip.target ?? 0) - (chip.position ?? 0))} µsteps away: the
          motor starts as soon as v_max is written.
        </p>
      )}
      {mode === "soft" && chip !== null && chip.mode > 1 && (
        <p className={classes.caution}>
          The chip is in {MODES[chip.mode]} mode and is not switched at rest: a move puts it in ramp mode, after which
          soft mode can be sent.
        </p>
      )}
      {differences && (
        <table className={classes.diff}>
          <thead>
            <tr>
              <th scope="col">register</th>
              <th scope="col">chip</th>
              <th scope="col">design</th>
              <th scope="col">last sent</th>
            </tr>
          </thead>
          <tbody>
            {differences.map((row) => (
              <tr key={row.key} data-changed={row.from !== row.to || undefined}>
                <th scope="row">{row.label}</th>
                <td className="num">{shown(row, row.from)}</td>
                <td className="num">{shown(row, row.to)}</td>
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
        {stop.isError && <ProblemAlert error={stop.error} doing="Stopping the axis" onClose={stop.reset} />}
        {move.data && (
          <p className={classes.hint}>
            {move.data.text} {move.data.warnings.join(" ")}
          </p>
        )}
      </div>
    </Section>
  );
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
  const value = row.register === row.label ? written.value : written.fields[row.label];
  const good = written.verified !== false;
  return (
    <span className={good ? classes.good : classes.fault}>
      {good ? <IconCheck size={12} aria-hidden /> : <IconX size={12} aria-hidden />}
      <span className="num"> read back {shown(row, value ?? null)}</span>
    </span>
  );
}
