import { Button, FileButton, Select, Text } from "@mantine/core";
import { IconFileUpload } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { useEffect, useRef, useState } from "react";
import { api, type Schemas } from "../../api/client";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { lineOf } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { Plot } from "../../plots/Plot";
import type { PlotHandle } from "../../plots/types";
import { type RecordingDetail, useChanges } from "./api";
import { unitText } from "./channels";
import classes from "./recordings.module.css";
import type { Window } from "./ZoomData";

type Added = Schemas["AddedFile"];

const POINTS = 2000;

interface Props {
  detail: RecordingDetail;
  window: Window | null;
}

/** What another instrument has measured of the same time: CSV files, dropped in and aligned with the recording. */
export function AddedFiles({ detail, window }: Props) {
  const changes = useChanges();
  const [over, setOver] = useState(false);
  const [busy, setBusy] = useState(false);
  const [problem, setProblem] = useState<{ doing: string; error: unknown } | null>(null);
  const attempt = async (doing: string, work: () => Promise<unknown>) => {
    setProblem(null);
    setBusy(true);
    await work().catch((error: unknown) => setProblem({ doing, error }));
    setBusy(false);
  };
  const take = (files: readonly File[]) =>
    attempt(`Reading ${files.map(({ name }) => name).join(", ")}`, async () => {
      for (const file of files) await changes.addFile(detail.id, file);
    });
  return (
    <Card
      title="Other instruments"
      aria-label="Other instruments"
      className={classes.drop ?? ""}
      data-over={over}
      aria-busy={busy}
      actions={
        <FileButton multiple accept=".csv,.txt,.tsv,text/csv" onChange={(files) => void take(files)}>
          {(props) => (
            <Button {...props} variant="default" loading={busy} leftSection={<IconFileUpload size={14} aria-hidden />}>
              Add a CSV file
            </Button>
          )}
        </FileButton>
      }
      onDragOver={(event) => {
        if (!event.dataTransfer.types.includes("Files")) return;
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={() => setOver(false)}
      onDrop={(event) => {
        event.preventDefault();
        setOver(false);
        void take([...event.dataTransfer.files]);
      }}
    >
      {problem && <ProblemAlert {...problem} onClose={() => setProblem(null)} />}
      {detail.added.length === 0 && (
        <Text size="xs" className="dim">
          Drop the CSV file of an oscilloscope or another instrument here: its channels are drawn and measured beside
          those of the recording.
        </Text>
      )}
      {detail.added.map((file) => (
        <AddedFile key={file.number} detail={detail} file={file} window={window} busy={busy} attempt={attempt} />
      ))}
    </Card>
  );
}

interface FileProps extends Props {
  file: Added;
  busy: boolean;
  attempt: (doing: string, work: () => Promise<unknown>) => Promise<void>;
}

function AddedFile({ detail, file, window, busy, attempt }: FileProps) {
  const changes = useChanges();
  const align = (to: Schemas["Align"]) =>
    void attempt(`Aligning ${file.name}`, () => changes.alignFile(detail.id, file.number, to));
  const [first] = file.channels;
  return (
    <section aria-label={file.name} className="stack gap-4 mb-8" data-testid="added-file">
      <div className="row wrap gap-8 mid">
        <b className="anywhere">{file.name}</b>
        <span className="hint">
          {file.instrument} · {fixed(file.rows)} rows · {fixed(file.from_s, 3)} to {fixed(file.to_s, 3, "s")}
        </span>
        <NumberField
          size="xs"
          w={130}
          aria-label={`Where the 0 of ${file.name} lies, s`}
          unit="s"
          value={file.offset_s}
          disabled={busy}
          onChange={(offset_s) => align({ offset_s })}
        />
        <Select
          size="xs"
          w={190}
          aria-label={`Recorded channel that ${first?.name ?? file.name} looks like`}
          placeholder="looks like …"
          data={detail.channels.map(({ name }) => name)}
          value={null}
          disabled={busy}
          onChange={(like) => like && align({ like })}
        />
        <Select
          size="xs"
          w={190}
          searchable
          aria-label={`Mark that the 0 of ${file.name} lies on`}
          placeholder="0 on a mark …"
          nothingFoundMessage="no such mark"
          data={detail.marks.map((mark, index) => ({
            value: String(index),
            label: `${fixed(mark.time_s - (detail.zero_s ?? 0), 3, "s")} ${mark.text}`,
          }))}
          limit={100}
          value={null}
          disabled={busy || detail.marks.length === 0}
          onChange={(mark) => mark !== null && align({ mark: Number(mark) })}
        />
        <Button
          size="compact-xs"
          variant="subtle"
          className="push"
          disabled={busy}
          onClick={() => void attempt(`Removing ${file.name}`, () => changes.removeFile(detail.id, file.number))}
        >
          Remove
        </Button>
      </div>
      <Text size="xs" className="dim">
        Aligned: {[file.aligned, ...file.notes].join("; ")}
      </Text>
      <Curves detail={detail} file={file} window={window} />
    </section>
  );
}

/** The channels of a file in the stretch that the recording's plots show. */
function Curves({ detail, file, window }: Props & { file: Added }) {
  const names = file.channels.map(({ name }) => name);
  const plot = useQuery({
    queryKey: ["added", detail.id, file.number, names, file.offset_s, window],
    queryFn: () =>
      api.GET("/api/v1/recordings/{recording}/plot", {
        path: { recording: detail.id },
        query: { channel: names, points: POINTS, ...(window && { from_s: window[0], to_s: window[1] }) },
      }) as unknown as Promise<Schemas["RecordingPlot"]>,
    placeholderData: (before) => before,
  });
  if (plot.isError) return <ProblemAlert error={plot.error} doing={`Drawing ${file.name}`} />;
  const range = window ?? [Math.min(0, file.from_s), Math.max(detail.duration_s, file.to_s)];
  return plot.data?.curves.map((curve) => (
    <CurvePlot key={curve.channel} id={detail.id} curve={curve} from={range[0]} to={range[1]} />
  ));
}

function CurvePlot({ id, curve, from, to }: { id: string; curve: Schemas["Curve"]; from: number; to: number }) {
  const scheme = useScheme();
  const handle = useRef<PlotHandle>(null);
  useEffect(() => handle.current?.setData([curve.time_s, curve.values], [from, to]), [curve, from, to]);
  return (
    <Plot
      label={`${curve.channel} over time${curve.unit ? ` in ${unitText(curve.unit)}` : ""}`}
      series={[{ label: curve.channel, unit: curve.unit, ...lineOf(curve.channel, scheme) }]}
      x={{ label: "time", unit: "s" }}
      scales={{ y: { unit: curve.unit } }}
      height={150}
      group={`recording-${id}`}
      legend
      handle={handle}
    />
  );
}
