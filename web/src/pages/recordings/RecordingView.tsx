import { Box, Button, Group, Progress, SegmentedControl, Text, TextInput, UnstyledButton } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { IconArrowsDiff, IconFlag, IconPlayerStop, IconRepeat } from "@tabler/icons-react";
import { useCallback, useState } from "react";
import { Link, useLocation } from "wouter";
import { Card } from "../../lib/Card";
import { optionsOf } from "../../lib/choices";
import { duration, fixed, sizeText } from "../../lib/format";
import { Loading } from "../../lib/Loading";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useScheme } from "../../lib/useScheme";
import { RecordingTwin } from "../twin/RecordingTwin";
import { AddedFiles } from "./AddedFiles";
import { isRunning, type RecordingDetail, titleOf, useChanges, useFigures, useRecording } from "./api";
import { Configuration } from "./Configuration";
import { colorOfQuantity, labelOf, severalAxes } from "./channels";
import { FiguresTable } from "./FiguresTable";
import { Tags } from "./ListView";
import { MarkList } from "./MarkList";
import { Notebook } from "./Notebook";
import { PredictionSection } from "./PredictionSection";
import { RecordingPlots } from "./RecordingPlots";
import { RowMenu } from "./RowMenu";
import classes from "./recordings.module.css";
import { SpectrumSection } from "./SpectrumSection";
import { useReplay } from "./useReplay";
import { useView } from "./useView";
import { stateText, whenText } from "./words";
import type { Window } from "./ZoomData";

/** One recording: its plots, what happened, its figures, and how the device was set. */
export function RecordingView({ id }: { id: string }) {
  const recording = useRecording(id);
  if (recording.data === undefined)
    return recording.isError ? (
      <Page name="Recording">
        <ProblemAlert error={recording.error} doing="Reading the recording" retry={() => void recording.refetch()} />
        <Text size="sm">
          <Link href="/recordings" className={classes.link}>
            All recordings
          </Link>
        </Text>
      </Page>
    ) : (
      <Group justify="center" py="xl">
        <Loading label="Reading the recording" />
      </Group>
    );
  return <Loaded detail={recording.data} />;
}

function Loaded({ detail }: { detail: RecordingDetail }) {
  const scheme = useScheme();
  const { window, setWindow, hidden, setHidden } = useView();
  const [problem, setProblem] = useState<{ doing: string; error: unknown } | null>(null);
  const [ready, setReady] = useState(false);
  const [, go] = useLocation();
  const running = isRunning(detail);
  const several = severalAxes(detail.channels);
  const attempt = useCallback((doing: string, work: () => Promise<unknown>) => {
    setProblem(null);
    work().catch((error: unknown) => setProblem({ doing, error }));
  }, []);
  const title = titleOf(detail);
  const channels = measured(detail);
  return (
    <Page name={`Recording ${title}`}>
      {problem && <ProblemAlert {...problem} onClose={() => setProblem(null)} />}
      <Card
        title={title}
        note={
          <span className="tabular">
            {detail.device} · {detail.model} · {whenText(detail.started_unix_s)} · {duration(detail.duration_s)} at{" "}
            {detail.rate_hz} Hz · {sizeText(detail.size_bytes)}
          </span>
        }
        actions={
          <>
            <Link href="/recordings" className={classes.link}>
              All recordings
            </Link>
            {running ? <RunningActions detail={detail} attempt={attempt} /> : <ReplayAction detail={detail} />}
            <RowMenu recording={detail} attempt={attempt} window={window} onRemoved={() => go("/recordings")} />
          </>
        }
      >
        <fieldset className={`bare row wrap gap-6 mb-4`} aria-label="Channels shown">
          {detail.channels.map((channel) => {
            const label = labelOf(channel, several);
            return (
              <UnstyledButton
                key={channel.name}
                className={`${classes.struck} tag inline gap-4`}
                aria-pressed={!hidden.has(label)}
                onClick={() => {
                  const next = new Set(hidden);
                  if (!next.delete(label)) next.add(label);
                  setHidden(next);
                }}
              >
                <span
                  className="swatch"
                  style={{ background: colorOfQuantity(channel.quantity, scheme) }}
                  aria-hidden
                />
                {label}
              </UnstyledButton>
            );
          })}
          <Tags recording={detail} />
          {running && <span className="dim">{stateText(detail)}</span>}
          {window && (
            <Button size="compact-xs" variant="default" onClick={() => setWindow(null)}>
              Show all
            </Button>
          )}
        </fieldset>
        {detail.message && <Text size="sm">{detail.message}</Text>}
        <RecordingPlots
          detail={detail}
          window={window}
          onWindow={setWindow}
          hidden={hidden}
          onReady={() => setReady(true)}
        />
      </Card>
      <RecordingTwin recording={detail.id} />
      <div className={`${classes.below} columns until-62`}>
        <div className="grid shrink gap-8">
          <FiguresSection detail={detail} window={window} ready={ready} />
          {!running && <PredictionSection detail={detail} window={window} onWindow={setWindow} />}
          {!running && <AddedFiles detail={detail} window={window} />}
          <SpectrumSection recordings={[detail]} channels={channels} window={window} running={running} />
        </div>
        <div className="grid shrink gap-8">
          <MarkList detail={detail} onGo={setWindow} />
          <Notebook detail={detail} window={window} hidden={hidden} onGo={setWindow} />
          {detail.note && (
            <Card title="Note">
              <Text size="sm" className={classes.note}>
                {detail.note}
              </Text>
            </Card>
          )}
          <Configuration detail={detail} />
        </div>
      </div>
    </Page>
  );
}

/** Its channels, and those of files beside it. */
function measured({ channels, added }: RecordingDetail) {
  return [...channels, ...added.flatMap((file) => file.channels)];
}

interface ActionProps {
  detail: RecordingDetail;
  attempt: (doing: string, work: () => Promise<unknown>) => void;
}

function RunningActions({ detail, attempt }: ActionProps) {
  const changes = useChanges();
  const [text, setText] = useState("");
  return (
    <>
      <Box
        component="form"
        w={190}
        onSubmit={(event) => {
          event.preventDefault();
          const words = text.trim();
          if (words === "") return;
          setText("");
          attempt("Marking", () => changes.mark(detail.id, words));
        }}
      >
        <TextInput
          aria-label="Mark this moment"
          placeholder="mark this moment"
          maxLength={400}
          leftSection={<IconFlag size={14} aria-hidden />}
          value={text}
          onChange={(event) => setText(event.currentTarget.value)}
        />
      </Box>
      <Button
        leftSection={<IconPlayerStop size={15} aria-hidden />}
        onClick={() => attempt("Ending the recording", () => changes.stop(detail.id))}
      >
        End recording
      </Button>
    </>
  );
}

/** Live through it once more on an emulator; then both are laid on each other. */
function ReplayAction({ detail }: { detail: RecordingDetail }) {
  const { start, replay, problem, dismiss } = useReplay(detail.id);
  const [, go] = useLocation();
  if (problem !== null) return <ProblemAlert error={problem} doing="Replaying" onClose={dismiss} />;
  if (replay?.state === "running")
    return (
      <span className="inline gap-8 text-12 tabular" role="status">
        Replaying {fixed(replay.done_s, 1)} of {fixed(replay.duration_s, 1, "s")}
        <Progress
          value={(100 * replay.done_s) / Math.max(replay.duration_s, 1e-9)}
          size={6}
          w={90}
          aria-label="Replayed"
        />
      </span>
    );
  const compared = detail.replay_of
    ? `${detail.replay_of},${detail.id}`
    : replay?.state === "done" && replay.recording
      ? `${detail.id},${replay.recording}`
      : null;
  return (
    <>
      {replay?.state === "failed" && <span className="caution text-12">Not replayed: {replay.message}</span>}
      {compared && (
        <Button
          variant="light"
          leftSection={<IconArrowsDiff size={15} aria-hidden />}
          onClick={() => go(`/recordings/compare?of=${compared}`)}
        >
          Compare with its {detail.replay_of ? "original" : "replay"}
        </Button>
      )}
      {!detail.replay_of && (
        <Button
          variant="default"
          leftSection={<IconRepeat size={15} aria-hidden />}
          onClick={start}
          title="The same configuration and commands on an emulator of its own; nothing on the bench moves"
        >
          {replay ? "Replay again" : "Replay on an emulator"}
        </Button>
      )}
      {replay?.state === "done" && replay.left_out.length > 0 && (
        <details className="text-12">
          <summary>
            {replay.left_out.length} {replay.left_out.length === 1 ? "thing was" : "things were"} not replayed
          </summary>
          <ul className="my-4 indent">
            {replay.left_out.map((line) => (
              <li key={line}>{line}</li>
            ))}
          </ul>
        </details>
      )}
    </>
  );
}

function FiguresSection({ detail, window, ready }: { detail: RecordingDetail; window: Window | null; ready: boolean }) {
  const [of, setOf] = useState("shown");
  const [settled] = useDebouncedValue(of === "shown" ? window : null, 250);
  const figures = useFigures(detail.id, settled, detail.rows ?? 0, ready);
  return (
    <Card
      title="Figures"
      note={
        figures.data && (
          <span className="num">
            {fixed(figures.data.from_s, 3)} to {fixed(figures.data.to_s, 3, "s")}
          </span>
        )
      }
      actions={
        <SegmentedControl
          aria-label="Figures of"
          data={optionsOf({ shown: "What is shown", all: "All of it" })}
          value={of}
          onChange={setOf}
        />
      }
    >
      <ProblemAlert error={figures.error} doing="Figures" />
      {figures.data && (
        <FiguresTable
          channels={measured(detail)}
          sides={[{ id: detail.id, name: "", figures: figures.data.figures }]}
          stale={figures.isPlaceholderData}
        />
      )}
    </Card>
  );
}
