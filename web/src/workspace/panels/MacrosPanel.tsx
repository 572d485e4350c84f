import { Alert, Button, Group, Text } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect, useId, useState } from "react";
import { api, type Schemas } from "../../api/client";
import { putIntoAddress, useAddress } from "../../lib/address";
import { Card } from "../../lib/Card";
import { counted, fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useWork } from "../../lib/useWork";
import type { DeviceProps } from "../panel";
import { MacroEditor } from "./MacroEditor";

type Document = Schemas["MacroDocument"];
type Info = Schemas["MacroInfo"];
/** What stands open: of a kept macro its id and revision, of a new one neither. */
export type Opened = { id: string | null; revision: number; document: Document; leftOut: readonly string[] };

/** While one runs, and else. */
const POLL_MS = { running: 250, resting: 1000 };
const RECORDING = "stepscope.macro-recording";

/** The audit entry behind which the recording of that device began; in this tab alone, over a reload. */
const begun = (device: string) => {
  const kept = sessionStorage.getItem(`${RECORDING}.${device}`);
  return kept === null ? null : Number(kept);
};

/** Macros: made of what is done to the device, tried on its twin, and run; a button each. */
export function MacrosPanel({ device }: DeviceProps) {
  return <MacrosOf key={device.id} device={device} />; // what is recorded, open or tried is of one device
}

function MacrosOf({ device }: Pick<DeviceProps, "device">) {
  const queries = useQueryClient();
  const path = { device: device.id };
  const [after, setAfter] = useState(() => begun(device.id));
  const [opened, setOpened] = useState<Opened | null>(null);
  const [trial, setTrial] = useState<{ info: Info; came: Schemas["MacroTrial"] } | null>(null);
  const macros = useQuery({ queryKey: ["macros"], queryFn: () => api.GET("/api/v1/macros", {}) });
  const standing = useQuery({
    queryKey: ["macro-run", device.id],
    queryFn: () => api.GET("/api/v1/devices/{device}/macro-run", { path }),
    refetchInterval: ({ state }) => POLL_MS[state.data?.run.state === "running" ? "running" : "resting"],
  });
  const run = standing.data?.run;
  const refresh = () => {
    void queries.invalidateQueries({ queryKey: ["macros"] });
    void queries.invalidateQueries({ queryKey: ["macro-run", device.id] });
  };
  const record = useWork(async () => {
    const key = `${RECORDING}.${device.id}`;
    if (after === null) {
      const answer = await api.GET("/api/v1/audit", { query: { limit: 1 } });
      const newest = (answer as Schemas["AuditPage"]).entries[0]?.id ?? 0;
      sessionStorage.setItem(key, String(newest));
      setAfter(newest);
      return;
    }
    const draft = await api.GET("/api/v1/devices/{device}/macro-draft", { path, query: { after } });
    sessionStorage.removeItem(key);
    setAfter(null);
    setOpened({ id: null, revision: 0, document: draft.document, leftOut: draft.left_out });
  });
  const { macro: asked } = useAddress("macro");
  const open = useMutation({
    mutationFn: async (id: string) => {
      const kept = await api.GET("/api/v1/macros/{macro}", { path: { macro: id } });
      setOpened({ id: kept.id, revision: kept.revision, document: kept.document, leftOut: [] });
    },
  });
  const { mutate: openAsked } = open;
  useEffect(() => {
    if (asked !== "") openAsked(asked);
  }, [asked, openAsked]);
  const all = macros.data?.macros ?? [];
  const fitting = all.filter(({ model }) => model === "" || model === device.model);
  const stop = useWork(async () => {
    await api.DELETE("/api/v1/devices/{device}/macro-run", { path });
    refresh();
  });
  return (
    <Card
      title="Macros"
      note={device.name}
      className="text-13 stack gap-8"
      actions={
        <Button size="compact-sm" variant={after === null ? "default" : "filled"} onClick={record.mutate}>
          {after === null ? "Record" : "Stop recording"}
        </Button>
      }
    >
      {after !== null && <Text size="sm">What you do to {device.name} now becomes steps.</Text>}
      <ProblemAlert error={record.error ?? stop.error ?? open.error ?? macros.error} doing="Macros" />
      {opened !== null && (
        <MacroEditor
          key={`${opened.id}/${opened.revision}`}
          opened={opened}
          onClose={() => {
            setOpened(null);
            putIntoAddress({ macro: "" }, "replace");
            refresh();
          }}
        />
      )}
      {macros.data?.macros.length === 0 && opened === null && (
        <Text size="sm">No macro is kept yet: press Record, do something, and stop.</Text>
      )}
      {fitting.map((info) => (
        <MacroRow
          key={info.id}
          info={info}
          device={device}
          busy={run?.state === "running" ? run.name : null}
          passed={standing.data?.tried.find(({ macro }) => macro === info.id)?.passed ?? null}
          onTrial={(came) => setTrial({ info, came })}
          onEdit={() => open.mutate(info.id)}
          refresh={refresh}
        />
      ))}
      {all.length > fitting.length && (
        <p className="hint m-0">
          {`${all.length - fitting.length} more ${all.length - fitting.length === 1 ? "is" : "are"} for other models than ${device.title}.`}
        </p>
      )}
      {trial !== null && <Trial {...trial} onClose={() => setTrial(null)} />}
      {run !== undefined && run.state !== "idle" && (
        <section aria-label="Run" data-testid="macro-run">
          <Group justify="space-between" gap="xs">
            <Text size="sm" role="status">
              {run.name}: {run.state}
              {run.state === "running" && `, step ${run.step} of ${run.steps}: ${run.text}`}
              {run.state === "running" && run.left_s !== null && `, ${fixed(run.left_s, 1)} s left`}
            </Text>
            {run.state === "running" && (
              <Button size="compact-sm" color="red" onClick={stop.mutate}>
                Stop
              </Button>
            )}
          </Group>
          {run.message !== "" && (
            <Alert color="red" p="xs" role="alert">
              {run.message}. {run.way_out}
            </Alert>
          )}
          {run.state !== "running" && <Done steps={run.done} />}
        </section>
      )}
    </Card>
  );
}

interface RowProps {
  info: Info;
  device: DeviceProps["device"];
  /** the macro that runs; null: none does */
  busy: string | null;
  passed: boolean | null;
  onTrial: (came: Schemas["MacroTrial"]) => void;
  onEdit: () => void;
  refresh: () => void;
}

function MacroRow({ info, device, busy, passed, onTrial, onEdit, refresh }: RowProps) {
  const hint = useId();
  const path = { device: device.id };
  const order = { macro: info.id, revision: info.revision };
  const attempt = useWork(async () => {
    onTrial(await api.POST("/api/v1/devices/{device}/macro-trial", { path, body: order }));
    refresh();
  });
  const run = useWork(async () => {
    await api.POST("/api/v1/devices/{device}/macro-run", { path, body: order });
    refresh();
  });
  const untried = passed === null ? "not tried in this revision" : passed ? "tried" : "did not pass its trial";
  const off = device.state !== "connected" ? `${device.name} is not connected` : busy !== null ? `${busy} runs` : null;
  const why =
    off ??
    (passed === null
      ? "Try shows on a twin what it does; nothing here moves"
      : passed
        ? null
        : "on a twin it did not come to its end: Try shows where");
  return (
    <Group gap="xs" justify="space-between" data-testid={`macro-${info.id}`}>
      <Text size="sm">
        {info.name} <span className="hint">{`${counted(info.steps, "step")}, ${untried}`}</span>
        {why !== null && (
          <span className="hint" id={hint}>
            {`. ${why}`}
          </span>
        )}
      </Text>
      <Group gap={6}>
        <Button size="compact-sm" variant="default" onClick={onEdit}>
          Edit
        </Button>
        <Button
          size="compact-sm"
          variant={passed ? "default" : "filled"}
          loading={attempt.isPending}
          onClick={attempt.mutate}
        >
          Try
        </Button>
        <Button
          size="compact-sm"
          variant={passed ? "filled" : "default"}
          disabled={off !== null}
          aria-describedby={why === null ? undefined : hint}
          onClick={run.mutate}
        >
          {passed ? "Run" : "Run untried"}
        </Button>
      </Group>
      <ProblemAlert error={attempt.error ?? run.error} doing={info.name} />
    </Group>
  );
}

function Trial({ info, came, onClose }: { info: Info; came: Schemas["MacroTrial"]; onClose: () => void }) {
  return (
    <Alert
      p="xs"
      color={came.passed ? "green" : "yellow"}
      title={`${info.name} on a twin: ${came.passed ? "came to its end" : "did not pass"}`}
      withCloseButton
      closeButtonLabel="Close"
      onClose={onClose}
      data-testid="macro-trial"
    >
      {came.why_not !== "" ? came.why_not : came.run.message}
      {came.axes.map((axis) => (
        <div key={axis.axis}>
          Axis {axis.axis}: {axis.start} to {axis.end}, between {axis.least} and {axis.greatest} microsteps
        </div>
      ))}
      {came.warnings.map((warning) => (
        <div key={warning}>{warning}</div>
      ))}
      <Done steps={came.run.done} />
    </Alert>
  );
}

function Done({ steps }: { steps: readonly Schemas["MacroStepDone"][] }) {
  return (
    <ol className="m-0">
      {steps.map(({ number, text, came }) => (
        <li key={number}>
          {text}
          {came !== "" && <span className="hint">: {came}</span>}
        </li>
      ))}
    </ol>
  );
}
