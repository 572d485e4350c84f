import { Group, Text } from "@mantine/core";
import { IconReportAnalytics } from "@tabler/icons-react";
import { useState } from "react";
import { Link, useSearch } from "wouter";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { duration } from "../../lib/format";
import { Loading } from "../../lib/Loading";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { type RecordingDetail, titleOf, useRecording, useRecordings } from "./api";
import { idsOf } from "./compare";
import { RecordingPlots } from "./RecordingPlots";
import classes from "./recordings.module.css";
import { whenText } from "./words";
import type { Window } from "./ZoomData";

/** Plots of more would keep a browser busy for long. */
export const REPORTED_MAX = 12;
const NOTHING: ReadonlySet<string> = new Set();

/** Several recordings one below the other, each with its plots and what its note says: those of `?of=a,b`, or those
 * that a search finds (`?search=tuning session`), which an address can name before they are made. */
export function ReportView() {
  const search = useSearch();
  const ids = idsOf(search);
  const words = new URLSearchParams(search).get("search") ?? "";
  const list = useRecordings(words, REPORTED_MAX);
  const found = ids.length > 0 || words === "" ? ids : (list.data?.recordings ?? []).map(({ id }) => id).reverse();
  const reading = words !== "" && ids.length === 0 && list.data === undefined;
  const shown = found.slice(0, REPORTED_MAX);
  return (
    <Page name="Report of recordings">
      {reading && list.isError && (
        <ProblemAlert error={list.error} doing="Reading the list" retry={() => void list.refetch()} />
      )}
      {reading && !list.isError && <Waits what="Reading the list" />}
      {!reading && shown.length === 0 && (
        <EmptyState title="Nothing to report" icon={<IconReportAnalytics size={22} />}>
          <Text size="sm">
            {words ? `No recording has “${words}” in its name or note yet. ` : ""}Pick some in the{" "}
            <Link href="/recordings" className={classes.link}>
              list of recordings
            </Link>
            .
          </Text>
        </EmptyState>
      )}
      {shown.length > 0 && (
        <div className="grid shrink gap-8" data-testid="report">
          {shown.map((id) => (
            <Section key={id} id={id} />
          ))}
        </div>
      )}
    </Page>
  );
}

function Section({ id }: { id: string }) {
  const recording = useRecording(id);
  if (recording.data) return <Reported detail={recording.data} />;
  if (recording.isError)
    return (
      <ProblemAlert error={recording.error} doing="Reading the recording" retry={() => void recording.refetch()} />
    );
  return <Waits what="Reading the recording" />;
}

function Reported({ detail }: { detail: RecordingDetail }) {
  const [window, setWindow] = useState<Window | null>(null);
  return (
    <Card
      title={titleOf(detail)}
      note={
        <span className="tabular">
          {detail.device} · {detail.model} · {whenText(detail.started_unix_s)} · {duration(detail.duration_s)}
        </span>
      }
      actions={
        <Link href={`/recordings/${detail.id}`} className={classes.link}>
          Figures and settings
        </Link>
      }
    >
      {detail.note && (
        <Text size="sm" className={classes.note} mb="sm">
          {detail.note}
        </Text>
      )}
      <RecordingPlots detail={detail} window={window} onWindow={setWindow} hidden={NOTHING} onReady={ignored} />
    </Card>
  );
}

function ignored() {
  // no figures wait for the plots here
}

function Waits({ what }: { what: string }) {
  return (
    <Group justify="center" py="xl">
      <Loading label={what} />
    </Group>
  );
}
