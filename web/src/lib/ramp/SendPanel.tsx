import { Button } from "@mantine/core";
import { IconArrowsLeftRight, IconCheck, IconPlayerPlay, IconUpload, IconX } from "@tabler/icons-react";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { type ReactNode, useState } from "react";
import { api, type Schemas } from "../../api/client";
import { motion } from "../../api/motion";
import type { Device } from "../../api/queries";
import { Card } from "../Card";
import { fixed } from "../format";
import { ProblemAlert } from "../ProblemAlert";
import { useWork } from "../useWork";
import type { Dialect } from "./chip";
import { changedOf, type Difference, writesFor } from "./differences";

type Batch = Schemas["RegisterBatchResult"];

interface Props {
  device: Device | undefined;
  axis: number;
  connected: boolean;
  /** null while the registers of the design are not known */
  differences: readonly Difference[] | null;
  /** the registers of the latest change are awaited: those shown are of the design before, and not sent */
  stale?: boolean;
  /** of a module: whose parameters the registers are */
  dialect?: Dialect | null;
  /** why they are not */
  unknown: string;
  /** what device to add where there is none */
  wanted: string;
  /** how a value of a row is written; as a number by default */
  shown?: (row: Difference, value: number) => string;
  /** what there is to say before a write of the rows that differ */
  cautions?: (changed: readonly Difference[]) => ReactNode;
  /** null: the design is a move, else at what it rotates */
  rotation: Schemas["Rotate"] | null;
  /** of the move [microsteps] */
  distance: number;
  /** what the last column shows */
  proof?: string;
  /** what is to be known of the table, below it */
  foot?: string;
}

const DWELL_S = 0.4;

/** Chip against design, one click to the chip, and moves with it. */
export function SendPanel(props: Props) {
  const { device, axis, connected, differences, stale = false, rotation, distance } = props;
  const queries = useQueryClient();
  const [result, setResult] = useState<{ sent: string[]; answer: Batch } | null>(null);
  const id = device?.id ?? "";
  const at = { device: id, axis };
  const changed = changedOf(differences);
  const shown = (row: Difference, value: number | null) =>
    value === null ? "?" : (props.shown?.(row, value) ?? fixed(value));

  async function write(): Promise<boolean> {
    const writes = writesFor(changed, axis);
    if (writes.length === 0) return true;
    const answer = await api.POST("/api/v1/devices/{device}/registers", {
      path: { device: id },
      body: { writes: props.dialect ? writes.map(props.dialect.write) : writes },
    });
    setResult({ sent: writes.map((entry) => entry.name), answer });
    void queries.invalidateQueries({ queryKey: ["registers", id] });
    void queries.invalidateQueries({ queryKey: ["devices"] });
    return answer.failed === null && answer.done.every((entry) => entry.verified !== false);
  }

  const send = useWork(write);
  const move = useWork(async () => {
    if (!(await write())) return null;
    if (rotation !== null) {
      const started = await motion.rotate(at, rotation);
      return {
        text: `Rotates at ${fixed(started.velocity_pps, 0, "pps")} until it is stopped.`,
        warnings: started.warnings,
      };
    }
    const started = await motion.move(at, { target: distance, relative: true, unit: "microsteps" });
    return {
      text: `Moves from ${fixed(started.from_position)} to ${fixed(started.target_position)} µsteps.`,
      warnings: started.warnings,
    };
  });
  const shuttle = useQuery({
    queryKey: ["shuttle", id, axis],
    queryFn: () => api.GET("/api/v1/devices/{device}/axes/{axis}/shuttle", { path: at }),
    enabled: connected,
    refetchInterval: 1000,
  });
  const runs = shuttle.data?.running === true;
  const back = useWork(
    async () => {
      if (runs) await motion.endShuttle(at);
      else if (await write()) {
        const state = await api.GET("/api/v1/devices/{device}/axes/{axis}", { path: at });
        const first = Math.round(state.position);
        await motion.shuttle(at, { first: first + distance, second: first, dwell_s: DWELL_S });
      }
    },
    { onSettled: () => queries.invalidateQueries({ queryKey: ["shuttle"] }) },
  );
  const stop = useMutation({ mutationFn: async () => motion.stop(at, "ramp") });

  const busy = send.isPending || move.isPending || back.isPending;
  const why =
    device === undefined
      ? `No device: add ${props.wanted} under Connections to send this design.`
      : !connected
        ? `${device.name} is not connected: the design stays, connect it under Connections to send.`
        : differences === null
          ? props.unknown
          : null;

  return (
    <Card
      title="To the chip"
      note={
        why === null
          ? stale
            ? "calculating the registers"
            : changed.length === 0
              ? "the chip holds this design"
              : `${changed.length} ${changed.length === 1 ? "value differs" : "values differ"}`
          : ""
      }
      actions={
        <>
          <Button
            leftSection={<IconUpload size={14} aria-hidden />}
            disabled={why !== null || stale || changed.length === 0 || busy}
            loading={send.isPending}
            onClick={() => send.mutate()}
          >
            Send
          </Button>
          <Button
            variant="light"
            leftSection={<IconPlayerPlay size={14} aria-hidden />}
            disabled={why !== null || stale || busy || runs}
            loading={move.isPending}
            onClick={() => move.mutate()}
          >
            {rotation === null ? "Move with it" : "Rotate with it"}
          </Button>
          {(rotation === null || runs) && (
            <Button
              variant="light"
              leftSection={<IconArrowsLeftRight size={14} aria-hidden />}
              disabled={why !== null || ((busy || stale) && !runs)}
              loading={back.isPending}
              onClick={() => back.mutate()}
            >
              {runs ? "End there and back" : "There and back"}
            </Button>
          )}
          <Button variant="default" disabled={!connected} onClick={() => stop.mutate()}>
            Stop axis
          </Button>
        </>
      }
    >
      {why !== null && <p className="hint m-0">{why}</p>}
      {why === null && props.cautions?.(changed)}
      {differences && device && (
        <table className="figures">
          <thead>
            <tr>
              <th scope="col">register</th>
              <th scope="col">chip</th>
              <th scope="col">design</th>
              <th scope="col">{props.proof ?? "read back"}</th>
            </tr>
          </thead>
          <tbody>
            {differences.map((row) => (
              <tr key={row.label} data-changed={row.from !== row.to || undefined}>
                <th scope="row" className="mono">
                  {row.label}
                </th>
                <td className="num">{shown(row, row.from)}</td>
                <td className="num" data-best={row.from !== row.to}>
                  {shown(row, row.to)}
                </td>
                <td>
                  <Outcome row={row} result={result} shown={shown} raw={props.dialect?.raw} />
                </td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      {differences && device && props.foot !== undefined && <p className="hint my-8">{props.foot}</p>}
      <div aria-live="polite">
        {result?.answer.failed && <ProblemAlert error={result.answer.failed} doing="Sending the design" />}
        {send.isError && <ProblemAlert error={send.error} doing="Sending the design" onClose={send.reset} />}
        {move.isError && <ProblemAlert error={move.error} doing="Moving" onClose={move.reset} />}
        {back.isError && <ProblemAlert error={back.error} doing="Moving there and back" onClose={back.reset} />}
        {stop.isError && <ProblemAlert error={stop.error} doing="Stopping the axis" onClose={stop.reset} />}
        {move.data && !runs && (
          <>
            <p className="hint m-0">{move.data.text}</p>
            {move.data.warnings.map((warning) => (
              <Caution key={warning}>{warning}</Caution>
            ))}
          </>
        )}
        {runs && <p className="hint m-0">Moves there and back until it is ended or the axis is stopped.</p>}
      </div>
    </Card>
  );
}

/** Something that has to be said before a write. */
export function Caution({ children }: { children: ReactNode }) {
  return <p className="m-0 caution text-12">{children}</p>;
}

interface OutcomeProps {
  row: Difference;
  result: { sent: string[]; answer: Batch } | null;
  shown: (row: Difference, value: number | null) => string;
  raw: Dialect["raw"] | undefined;
}

/** How the register of a row fared in the last batch. */
function Outcome({ row, result, shown, raw }: OutcomeProps) {
  const index = result?.sent.indexOf(row.register) ?? -1;
  if (!result || index < 0) return <span className="hint">–</span>;
  const written = result.answer.done[index];
  if (!written) {
    const failed = index === result.answer.done.length && result.answer.failed !== null;
    return <span className="fault text-12">{failed ? "refused" : "not tried"}</span>;
  }
  const told = row.field === null ? written.value : written.fields[row.field];
  const value = told !== undefined && raw ? raw(row.register, told) : told;
  const good = written.verified !== false;
  return (
    <span className={good ? "good text-12" : "fault text-12"} title={written.note || undefined}>
      {good ? <IconCheck size={12} aria-hidden /> : <IconX size={12} aria-hidden />}
      <span className="num"> {shown(row, value ?? null)}</span>
    </span>
  );
}
