import { Button, Checkbox, Group, Select, Text } from "@mantine/core";
import { useQueries } from "@tanstack/react-query";
import { useMemo, useState } from "react";
import { api, type Schemas } from "../../api/client";
import { Card } from "../../lib/Card";
import { optionsOf } from "../../lib/choices";
import { compact, frequency } from "../../lib/format";
import { Loading } from "../../lib/Loading";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useScheme } from "../../lib/useScheme";
import { Plot } from "../../plots/Plot";
import type { Overlay, PlotSeries } from "../../plots/types";
import { titleOf } from "./api";
import { type Channel, colorOfQuantity, unitText } from "./channels";
import { sideLook } from "./compare";
import type { Window } from "./ZoomData";

type WindowName = NonNullable<NonNullable<Ask["window"]>>;
type Detrend = NonNullable<NonNullable<Ask["detrend"]>>;
interface Ask {
  window?: "hann" | "flattop" | "blackman" | "none";
  detrend?: "mean" | "line" | "none";
}
type Spectrum = Schemas["Spectrum"];

const WINDOWS: { value: WindowName; label: string }[] = optionsOf({
  hann: "Hann",
  flattop: "Flat top: amplitudes",
  blackman: "Blackman",
  none: "none",
});
const DETRENDS: { value: Detrend; label: string }[] = optionsOf({
  line: "without its slope",
  mean: "without its mean",
  none: "as it is",
});
const POINTS = 2000;

interface Props {
  recordings: readonly { id: string; name: string; colour?: string }[];
  channels: readonly Channel[];
  window: Window | null;
  /** what it would show changes with every second */
  running?: boolean;
}

/** What a channel swings at, of one recording or several. Worked out when it is asked for. */
export function SpectrumSection({ recordings, channels, window, running = false }: Props) {
  const scheme = useScheme();
  const [on, setOn] = useState(false);
  const [name, setName] = useState<string | null>(null);
  const [shape, setShape] = useState<WindowName>("hann");
  const [detrend, setDetrend] = useState<Detrend>("line");
  const [density, setDensity] = useState(false);
  const channel = channels.find((each) => each.name === name) ?? preferred(channels);
  const queries = useQueries({
    queries: recordings.map(({ id }) => ({
      queryKey: ["spectrum", id, channel?.name, window, shape, detrend],
      queryFn: (): Promise<Spectrum> =>
        api.GET("/api/v1/recordings/{recording}/spectrum", {
          path: { recording: id },
          query: {
            channel: channel?.name ?? "",
            window: shape,
            detrend,
            points: POINTS,
            ...(window ? { from_s: window[0], to_s: window[1] } : {}),
          },
        }),
      enabled: on && channel !== undefined,
      staleTime: running ? 0 : Number.POSITIVE_INFINITY,
      retry: false,
    })),
  });
  const problem = queries.find(({ error }) => error !== null)?.error ?? null;
  const spectra = queries.flatMap(({ data }, index) => (data ? [{ index, ...data }] : []));
  const [first, ...others] = spectra;
  const color =
    recordings.length > 1
      ? sideLook(0, scheme, recordings[0]?.colour).color
      : colorOfQuantity(channel?.quantity ?? "", scheme);
  const values = (spectrum: Spectrum) => (density ? spectrum.density : spectrum.amplitude);
  const data = useMemo(
    () => (first ? ([first.frequency_hz, density ? first.density : first.amplitude] as const) : undefined),
    [first, density],
  );
  const overlays: Overlay[] = others.map((spectrum) => ({
    x: spectrum.frequency_hz,
    y: values(spectrum),
    width: 1.5,
    ...sideLook(spectrum.index, scheme, recordings[spectrum.index]?.colour),
  }));
  const unit = channel?.unit ?? "";
  const series: PlotSeries[] = [{ label: density ? "power density" : "amplitude", color, unit }];
  if (channel === undefined) return null;
  return (
    <Card
      title="Spectrum"
      note={on && first && `${first.samples} samples, lines every ${frequency(first.line_hz)}`}
      actions={
        on ? (
          <>
            <Select
              w={170}
              aria-label="Channel of the spectrum"
              data={channels.map((each) => each.name)}
              value={channel.name}
              onChange={setName}
            />
            <Select
              w={150}
              aria-label="Window function"
              data={WINDOWS}
              value={shape}
              onChange={(value) => value && setShape(value as WindowName)}
            />
            <Select
              w={140}
              aria-label="What is taken off first"
              data={DETRENDS}
              value={detrend}
              onChange={(value) => value && setDetrend(value as Detrend)}
            />
            <Checkbox
              label="power density"
              checked={density}
              onChange={(event) => setDensity(event.currentTarget.checked)}
            />
          </>
        ) : (
          <Button variant="default" onClick={() => setOn(true)}>
            Work it out
          </Button>
        )
      }
    >
      <ProblemAlert error={problem} doing="Spectrum" />
      {on && first === undefined && problem === null && (
        <Group justify="center" py="md">
          <Loading size="sm" label="Working the spectrum out" />
        </Group>
      )}
      {on && first && data && (
        <div data-testid="spectrum">
          <Plot
            label={`Spectrum of ${channel.name}`}
            {...(first.peak_hz === null
              ? {}
              : { summary: `Highest at ${frequency(first.peak_hz)}, ${compact(first.peak)} ${unitText(unit)}` })}
            series={series}
            data={data}
            x={{ label: "frequency", unit: "Hz" }}
            scales={{ y: { unit: density ? `${unitText(unit) || "1"}²/Hz` : unit, include: [0] } }}
            overlays={overlays}
            height={220}
            legend
            limit={[0, first.frequency_hz.at(-1) ?? 1]}
          />
          <ul className="indent m-0 mt-4 text-12">
            {spectra.map((spectrum) => (
              <li key={spectrum.index}>
                {recordings.length > 1 && <b>{titleOf(recordings[spectrum.index] ?? { id: "", name: "" })}: </b>}
                {spectrum.peak_hz === null
                  ? "nothing swings"
                  : `highest at ${frequency(spectrum.peak_hz)}: ${compact(spectrum.peak)} ${unitText(unit)}`}
                {spectrum.resampled && "; times were uneven, read off along straight lines"}
              </li>
            ))}
          </ul>
        </div>
      )}
      {!on && (
        <Text size="xs" c="dimmed">
          What a channel swings at, in the part that the plots show.
        </Text>
      )}
    </Card>
  );
}

function preferred(channels: readonly Channel[]): Channel | undefined {
  for (const quantity of ["residual", "deviation", "velocity"]) {
    const found = channels.find((channel) => channel.quantity === quantity);
    if (found) return found;
  }
  return channels[0];
}
