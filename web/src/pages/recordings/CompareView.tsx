import { Group, SegmentedControl, Text } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { IconArrowsDiff } from "@tabler/icons-react";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { Link, useSearch } from "wouter";
import { api } from "../../api/client";
import { useAddressChoice } from "../../lib/address";
import { Card } from "../../lib/Card";
import { optionsOf } from "../../lib/choices";
import { EmptyState } from "../../lib/EmptyState";
import { compact, fixed } from "../../lib/format";
import { Loading } from "../../lib/Loading";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useScheme } from "../../lib/useScheme";
import { Plot } from "../../plots/Plot";
import type { PlotData } from "../../plots/series";
import type { Overlay, PlotSeries, WindowChange } from "../../plots/types";
import type { Comparison } from "./api";
import { labelOf, severalAxes, unitText } from "./channels";
import { channelsOf, idsOf, sideLook } from "./compare";
import { FiguresTable } from "./FiguresTable";
import classes from "./recordings.module.css";
import { SpectrumSection } from "./SpectrumSection";
import { useView } from "./useView";
import type { Window } from "./ZoomData";

type Align = "trigger" | "start" | "move";

/** Recordings laid on each other: what they share, and where they differ. */
export function CompareView() {
  const ids = idsOf(useSearch());
  const [align, setAlign] = useAddressChoice<Align>("align", ["trigger", "start", "move"]);
  const [view, setView] = useAddressChoice("show", ["overlay", "difference"]);
  const { window, setWindow } = useView();
  const [settled] = useDebouncedValue(window, 120);
  const query = useQuery({
    queryKey: ["compare", ids, align, settled],
    queryFn: () =>
      api.POST("/api/v1/recordings/compare", {
        body: {
          recordings: ids,
          align,
          points: 3000,
          from_s: settled ? settled[0] - (settled[1] - settled[0]) / 2 : null,
          to_s: settled ? settled[1] + (settled[1] - settled[0]) / 2 : null,
        },
      }),
    enabled: ids.length > 1,
    placeholderData: keepPreviousData,
    retry: false,
  });
  const [whole, setWhole] = useState<Window | null>(null);
  const { data } = query;
  if (data && settled === null && (whole?.[0] !== data.from_s || whole[1] !== data.to_s) && !query.isPlaceholderData)
    setWhole([data.from_s, data.to_s]);

  if (ids.length < 2)
    return (
      <EmptyState title="Nothing to compare" icon={<IconArrowsDiff size={22} />}>
        <Text size="sm">
          Pick two or more in the{" "}
          <Link href="/recordings" className={classes.link}>
            list of recordings
          </Link>
          .
        </Text>
      </EmptyState>
    );
  return (
    <Page name="Comparison of recordings">
      <Card
        title="Comparison"
        note={data && <Sides comparison={data} />}
        actions={
          <>
            <Link href="/recordings" className={classes.link}>
              All recordings
            </Link>
            <SegmentedControl
              aria-label="Laid on each other at"
              data={optionsOf({ trigger: "Trigger", move: "First move", start: "Start" })}
              value={align}
              onChange={(value) => {
                setAlign(value as Align);
                setWindow(null);
              }}
            />
            <SegmentedControl
              aria-label="Show"
              data={optionsOf({ overlay: "Overlay", difference: "Difference" })}
              value={view}
              onChange={(value) => setView(value as typeof view)}
            />
          </>
        }
      >
        <ProblemAlert error={query.error} doing="Comparing" retry={() => void query.refetch()} />
        {data === undefined && query.error === null && (
          <Group justify="center" py="xl">
            <Loading label="Comparing" />
          </Group>
        )}
        {data?.notes.map((note) => (
          <p key={note} className="my-4 caution text-12">
            {note}
          </p>
        ))}
        {data && (
          <ComparePlots
            comparison={data}
            difference={view === "difference"}
            whole={whole ?? [data.from_s, data.to_s]}
            window={window}
            onWindow={setWindow}
          />
        )}
      </Card>
      {data && (
        <div className="grid shrink gap-8">
          <Differences comparison={data} />
          <Card title="Figures side by side" {...(settled ? { note: "of the part around what is shown" } : {})}>
            <FiguresTable
              channels={channelsOf(data)}
              sides={data.recordings.map((side) => ({
                id: side.id,
                name: side.name || side.id,
                figures: side.figures,
              }))}
              stale={query.isPlaceholderData}
            />
          </Card>
          <SpectrumSection recordings={data.recordings} channels={channelsOf(data)} window={window} />
        </div>
      )}
    </Page>
  );
}

function Sides({ comparison }: { comparison: Comparison }) {
  const scheme = useScheme();
  const looks = comparison.recordings.map(({ colour }, index) => sideLook(index, scheme, colour));
  return (
    <span className="lines-12">
      {comparison.recordings.map((side, index) => (
        <span key={side.id} className="inline gap-6">
          <svg width={26} height={6} aria-hidden>
            <title>dash</title>
            <line
              x1={0}
              x2={26}
              y1={3}
              y2={3}
              stroke={looks[index]?.color}
              strokeWidth={2}
              strokeDasharray={looks[index]?.dash.join(" ")}
            />
          </svg>
          <Link href={`/recordings/${side.id}`} className={classes.link}>
            {side.name || side.id}
          </Link>
        </span>
      ))}
    </span>
  );
}

interface PlotsProps {
  comparison: Comparison;
  difference: boolean;
  /** what the difference is, for who does not see it */
  differing?: string;
  whole: Window;
  window: Window | null;
  onWindow: (window: Window | null) => void;
}

/** Plots of a comparison, a channel each: its curves, or how they differ. */
export function ComparePlots({ comparison, difference, differing, whole, window, onWindow }: PlotsProps) {
  const scheme = useScheme();
  const channels = channelsOf(comparison);
  const several = severalAxes(channels);
  const view = window ?? whole;
  const placeOf = (recording: string) => comparison.recordings.findIndex(({ id }) => id === recording);
  const change = (next: WindowChange) => {
    onWindow(next === "reset" || (next.min <= whole[0] && next.max >= whole[1]) ? null : [next.min, next.max]);
    return true;
  };
  return (
    <div className="grid shrink gap-4" data-testid="compare-plots">
      {comparison.channels.map((compared, index) => {
        const channel = channels[index];
        if (channel === undefined) return null;
        const shown = difference ? compared.differences : compared.curves;
        const overlays: Overlay[] = shown.map(({ recording, time_s, values }) => ({
          x: time_s,
          y: values.map((value) => value ?? Number.NaN),
          width: 1.5,
          ...sideLook(placeOf(recording), scheme, comparison.recordings[placeOf(recording)]?.colour),
        }));
        const series: PlotSeries[] = shown.map(({ recording }, nth) => ({
          label: comparison.recordings[placeOf(recording)]?.name || recording,
          color: overlays[nth]?.color ?? "",
        }));
        // The x column is only where the window is; what is drawn lies over it with times of its own.
        const frame: PlotData = [[view[0], view[1]], ...shown.map(() => [null, null])];
        const label = labelOf(channel, several);
        return (
          <Plot
            key={channel.name}
            label={
              difference
                ? `${label}: ${differing ?? "difference to the first recording"}`
                : `${label} of ${shown.length} recordings`
            }
            title={`${difference ? "Δ " : ""}${label}${channel.unit ? ` [${unitText(channel.unit)}]` : ""}`}
            series={series}
            data={frame}
            x={{ label: "time", unit: "s", axis: index === comparison.channels.length - 1 }}
            scales={{ y: { unit: channel.unit } }}
            height={Math.max(150, Math.round(560 / Math.max(1, comparison.channels.length)))}
            group="compare"
            legend
            limit={whole}
            overlays={overlays}
            onWindow={change}
          />
        );
      })}
    </div>
  );
}

interface DifferencesProps {
  comparison: Comparison;
  title?: string;
  note?: string;
}

/** Figures of the differences. */
export function Differences({ comparison, title = "Differences", note }: DifferencesProps) {
  const names = new Map(comparison.recordings.map(({ id, name }) => [id, name || id]));
  const channels = channelsOf(comparison);
  const several = severalAxes(channels);
  const rows = comparison.channels.flatMap((compared, index) =>
    compared.differences.map((difference) => ({ channel: channels[index], ...difference })),
  );
  if (rows.length === 0) return null;
  return (
    <Card
      title={title}
      note={
        note ??
        `to ${names.get(comparison.recordings[0]?.id ?? "")}, at its times, along straight lines between samples`
      }
    >
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: on a phone it scrolls sideways, with the keys too */}
      <section className="scroll-x" tabIndex={0} aria-label="Differences by channel">
        <table className="table text-13" data-testid="differences">
          <thead>
            <tr>
              <th>Channel</th>
              <th>Recording</th>
              {["Peak", "at", "Mean", "RMS", "Samples"].map((label) => (
                <th key={label} className="right">
                  {label}
                </th>
              ))}
            </tr>
          </thead>
          <tbody>
            {rows.map(({ channel, recording, figures }) => (
              <tr key={`${channel?.name}/${recording}`}>
                <th scope="row">
                  {channel && labelOf(channel, several)} <span className="dim">{unitText(channel?.unit ?? "")}</span>
                </th>
                <td className="dim">{names.get(recording)}</td>
                <td className="num right">{compact(figures.peak, 5)}</td>
                <td className="num right">{figures.peak_at_s === null ? "–" : fixed(figures.peak_at_s, 3, "s")}</td>
                <td className="num right">{compact(figures.mean, 5)}</td>
                <td className="num right">{compact(figures.rms, 5)}</td>
                <td className="num right">{fixed(figures.samples)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </section>
    </Card>
  );
}
