import { Alert, Button, FileButton, Group, Progress, SegmentedControl, Text, Textarea } from "@mantine/core";
import { IconPlayerPlay, IconPlayerStop, IconTimeline, IconUpload } from "@tabler/icons-react";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect, useState } from "react";
import { api, type Schemas } from "../../../api/client";
import { type Device, useDevices } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { optionsOf } from "../../../lib/choices";
import { compact, fixed } from "../../../lib/format";
import { NoDevice } from "../../../lib/NoDevice";
import { NumberField } from "../../../lib/NumberField";
import { Page } from "../../../lib/Page";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf } from "../../../lib/palette";
import { useCalc } from "../../../lib/useCalc";
import { useSessionKept } from "../../../lib/useKept";
import { useScheme } from "../../../lib/useScheme";
import { useWork } from "../../../lib/useWork";
import { useSelection } from "../../../live/selection";
import { Plot } from "../../../plots/Plot";
import { Drawing } from "./Drawing";
import { KNOTS_DRAWN_MAX, parsed, type Shape, shaped, split, textOf } from "./knots";

const PAGE = "Velocity profile";
const START = textOf(shaped("trapezoid", 4000, 2));

const onAxis = (device: string, axis: number) => ({ path: { device, axis } });

function Player({ device, axis }: { device: Device; axis: number }) {
  const connected = device.state === "connected";
  const key = ["velocity-profile", device.id, axis];
  const queries = useQueryClient();
  const [text, setText] = useSessionKept(`stepscope.velocity.${device.id}.${axis}`, START);
  const [rateHz, setRateHz] = useState(500);
  const read = parsed(text);
  const knots = "knots" in read ? read.knots : null;
  const body: Schemas["VelocityProfileBody"] | null = knots && {
    time_s: knots.map((knot) => knot.timeS),
    velocity_pps: knots.map((knot) => knot.pps),
    rate_hz: rateHz,
  };
  const check = useCalc<Schemas["VelocityProfileBody"], Schemas["VelocityProfileSummary"]>(
    `velocity-profile ${device.id} ${axis}`,
    connected ? body : null,
    (asked, signal) =>
      api.POST("/api/v1/devices/{device}/axes/{axis}/velocity-profile/check", {
        ...onAxis(device.id, axis),
        body: asked,
        signal,
      }),
  );
  const play = useQuery({
    queryKey: key,
    queryFn: ({ signal }) =>
      api.GET("/api/v1/devices/{device}/axes/{axis}/velocity-profile", { ...onAxis(device.id, axis), signal }),
    enabled: connected,
    refetchInterval: (query) => (query.state.data?.state === "running" ? 200 : 2000),
  });
  const running = play.data?.state === "running";
  const refresh = () => void queries.invalidateQueries({ queryKey: key });
  const start = useWork(
    async () => {
      if (body === null) throw new Error("There is no profile to play");
      return await api.POST("/api/v1/devices/{device}/axes/{axis}/velocity-profile", {
        ...onAxis(device.id, axis),
        body,
      });
    },
    { onSettled: refresh },
  );
  const stop = useWork(
    () => api.DELETE("/api/v1/devices/{device}/axes/{axis}/velocity-profile", onAxis(device.id, axis)),
    { onSettled: refresh },
  );
  const begin = (shape: Shape) => {
    const peak = Math.max(100, ...(knots ?? []).map((knot) => Math.abs(knot.pps)));
    setText(textOf(shaped(shape, peak, knots?.[knots.length - 1]?.timeS || 2)));
  };

  return (
    <Page name={PAGE}>
      <div className="columns design until-75">
        <div className="column">
          <Card title="v(t)" note="seconds and pps, a line each">
            <div className="grid gap-8">
              <Textarea
                aria-label="Profile as lines of time in seconds and velocity in pps"
                classNames={{ input: "num" }}
                autosize
                minRows={6}
                maxRows={14}
                value={text}
                error={"problem" in read ? read.problem : undefined}
                onChange={(event) => setText(event.currentTarget.value)}
              />
              <Group gap={6}>
                <FileButton accept=".csv,.txt,text/csv,text/plain" onChange={(file) => void file?.text().then(setText)}>
                  {(props) => (
                    <Button {...props} variant="default" leftSection={<IconUpload size={14} aria-hidden />}>
                      Load a CSV
                    </Button>
                  )}
                </FileButton>
                {(["trapezoid", "sine", "there and back"] as const).map((shape) => (
                  <Button key={shape} variant="subtle" onClick={() => begin(shape)}>
                    {shape}
                  </Button>
                ))}
              </Group>
              <NumberField
                label="Points a second"
                value={rateHz}
                min={1}
                max={2000}
                integer
                onChange={setRateHz}
                description="sent on straight lines between those above"
              />
            </div>
          </Card>
          <Play
            summary={check.result ?? null}
            error={check.error}
            state={play.data}
            disabled={!connected || knots === null || check.error !== null || check.stale}
            running={running}
            start={start}
            stop={stop}
          />
        </div>
        <div className="column">
          <Card
            title="Drawn"
            note="drag a knot, or move it by the arrow keys"
            actions={
              <Button
                size="compact-xs"
                variant="default"
                disabled={knots === null || knots.length >= KNOTS_DRAWN_MAX}
                onClick={() => knots && setText(textOf(split(knots)))}
              >
                Add a knot
              </Button>
            }
          >
            {knots === null || knots.length > KNOTS_DRAWN_MAX ? (
              <Text size="sm" c="dimmed">
                {knots === null ? "No profile: see the text." : `${fixed(knots.length)} points: too many to drag.`}
              </Text>
            ) : (
              <Drawing knots={knots} onChange={(next) => setText(textOf(next))} />
            )}
          </Card>
          <Lateness device={device} axis={axis} running={running} sent={play.data?.sent ?? 0} />
        </div>
      </div>
    </Page>
  );
}

interface PlayProps {
  summary: Schemas["VelocityProfileSummary"] | null;
  error: unknown;
  state: Schemas["VelocityProfileState"] | undefined;
  disabled: boolean;
  running: boolean;
  start: { mutate: () => void; isPending: boolean; error: unknown };
  stop: { mutate: () => void; isPending: boolean };
}

function Play({ summary, error, state, disabled, running, start, stop }: PlayProps) {
  return (
    <Card title="Play">
      <div className="grid gap-8">
        {error !== null && error !== undefined && <ProblemAlert error={error} doing="This profile cannot be played" />}
        {start.error !== null && <ProblemAlert error={start.error} doing="Playing" />}
        {summary && (
          <Text size="sm">
            {fixed(summary.points)} points in {compact(summary.duration_s, 4, "s")}, up to{" "}
            {compact(summary.peak_pps, 4, "pps")} and {compact(summary.acceleration_pps2)} pps². From{" "}
            {fixed(summary.lowest)} to {fixed(summary.highest)}, ends at {fixed(summary.end)} µsteps. The chip's step is{" "}
            {compact(summary.step_pps, 4, "pps")}.
          </Text>
        )}
        <Text size="xs" c="dimmed">
          The chip holds each velocity until the next comes: it plans no ramp, and stays in HOLD_MODE. Switches, soft
          limits and stops hold.
        </Text>
        <Group gap={6}>
          <Button
            leftSection={<IconPlayerPlay size={14} aria-hidden />}
            disabled={disabled || running}
            loading={start.isPending}
            onClick={start.mutate}
          >
            Play
          </Button>
          <Button
            variant="default"
            leftSection={<IconPlayerStop size={14} aria-hidden />}
            disabled={!running}
            onClick={stop.mutate}
          >
            Stop
          </Button>
        </Group>
        {state?.summary && state.state !== "idle" && (
          <div className="grid gap-8" data-testid="profile-state">
            <Progress
              aria-label="Points sent"
              value={(100 * (state.sent + state.skipped)) / state.summary.points}
              animated={running}
            />
            <Text size="sm" role="status">
              {running ? "Playing" : state.message}: {fixed(state.sent)} sent, {fixed(state.skipped)} left out
              {state.position !== null && `, stands at ${fixed(state.position)} (planned ${fixed(state.summary.end)})`}
            </Text>
            {state.skipped > 0 && (
              <Alert color="yellow" p="xs">
                Points were left out because the next was due already. Send fewer a second, or use a faster link.
              </Alert>
            )}
          </div>
        )}
      </div>
    </Card>
  );
}

function Lateness({ device, axis, running, sent }: { device: Device; axis: number; running: boolean; sent: number }) {
  const scheme = useScheme();
  const [over, setOver] = useState<"time" | "spread">("time");
  const late = useQuery({
    queryKey: ["velocity-profile-lateness", device.id, axis],
    queryFn: ({ signal }) =>
      api.GET("/api/v1/devices/{device}/axes/{axis}/velocity-profile/lateness", { ...onAxis(device.id, axis), signal }),
    enabled: device.state === "connected" && sent > 0,
    refetchInterval: running ? 1000 : false,
  });
  const { refetch } = late;
  useEffect(() => {
    if (!running && sent > 0) void refetch();
  }, [running, sent, refetch]);
  const times = late.data?.time_s ?? [];
  const values = late.data?.late_ms ?? [];
  const sorted = values.filter((each) => each !== null).sort((a, b) => a - b);
  const share = sorted.map((_, index) => (100 * (index + 1)) / sorted.length);
  const at = (percent: number) => sorted[Math.max(0, Math.ceil((percent / 100) * sorted.length) - 1)] ?? 0;
  return (
    <Card
      title="Lateness of each point"
      note={
        sorted.length > 0
          ? `half within ${compact(at(50), 4, "ms")}, 99 % within ${compact(at(99), 4, "ms")}`
          : undefined
      }
      actions={
        <SegmentedControl
          aria-label="Lateness as"
          data={optionsOf({ time: "Over time", spread: "Share within" })}
          value={over}
          onChange={(value) => setOver(value as "time" | "spread")}
        />
      }
    >
      {sorted.length === 0 ? (
        <Text size="sm" c="dimmed">
          Nothing played yet. Each point then shows how long after its time the chip had answered it.
        </Text>
      ) : over === "time" ? (
        <Plot
          label="Lateness over time"
          series={[{ label: "late", color: colorOf("residual", scheme), unit: "ms", dots: 3, line: false }]}
          data={[times, values]}
          x={{ label: "time", unit: "s" }}
          scales={{ y: { unit: "ms", include: [0] } }}
          height={220}
        />
      ) : (
        <Plot
          label="Share of points within a lateness"
          series={[{ label: "of the points", color: colorOf("residual", scheme), unit: "%" }]}
          data={[sorted, share]}
          x={{ label: "late", unit: "ms" }}
          scales={{ y: { unit: "%", range: [0, 100] } }}
          height={220}
        />
      )}
    </Card>
  );
}

/** A velocity over time, drawn or loaded, checked, and played point by point with the lateness of each. */
export default function VelocityPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  if (devices.isPending) return null;
  if (device === undefined)
    return (
      <Page name={PAGE}>
        <NoDevice icon={<IconTimeline size={22} aria-hidden />} wanted="a chip that takes velocities one by one" />
      </Page>
    );
  return <Player key={`${device.id}/${axis}`} device={device} axis={axis} />;
}
