import { type ReactNode, useState } from "react";
import type { Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { Page } from "../../lib/Page";
import { colorOf } from "../../lib/palette";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import type { Settings } from "../../lib/rows/settings";
import { useScheme } from "../../lib/useScheme";
import { useTelemetry } from "../../live/useTelemetry";
import { LiveNumber } from "../module/LiveNumber";
import { StopsList } from "../module/StopsList";
import { useHeldRun } from "../module/useHeldRun";
import { useStops } from "../module/useStops";
import { AngleView } from "./AngleView";
import type { Direction } from "./angleMap";
import classes from "./encoder.module.css";
import { Harmonics } from "./Harmonics";
import { HistogramView } from "./HistogramView";
import { LivePlots } from "./LivePlots";
import type { Curve } from "./Polar";
import { SlowTurn } from "./SlowTurn";
import { ACCELERATION, LIMIT } from "./settings";
import { channelsFor, ENCODERS, encoderName, useAngleMaps, type Which } from "./useEncoder";

/** Odd on purpose: at a round rate and a round speed every turn would be sampled at the same few angles. */
export const RATE_HZ = 193.2;
export const KEEP_S = 120;

/** What the panels at the side get of the page. */
export interface Tools {
  shown: readonly Which[];
  microstepsPerTurn: number;
  /** the samples have an encoder position */
  counted: () => boolean;
  counter: { actual: () => number; moving: () => boolean; onSet: () => void; disabled: boolean };
}

interface Props {
  device: Device;
  axis: Device["axes"][number];
  encoders: readonly Which[];
  settings: Settings;
  /** what is set, beside the views */
  side: (tools: Tools) => ReactNode;
  /** where there are many settings the stops stand under the views: the lower right would be blank */
  stopsUnder?: "settings" | "views";
  notice?: ReactNode;
  foot?: ReactNode;
}

/** What the encoder says of the shaft, over time and over the turn. */
export function EncoderView({ device, axis, encoders, settings, side, stopsUnder = "settings", notice, foot }: Props) {
  const scheme = useScheme();
  const at = { device: device.id, axis: axis.index };
  const connected = device.state === "connected";
  const [shown, setShown] = useState<readonly Which[]>(encoders.slice(0, 1));
  const [direction, setDirection] = useState<Direction>("both");
  const rateHz = Math.min(RATE_HZ, device.rate_max_hz);
  const { source, link, buffer } = useTelemetry(device.id, channelsFor(device, axis.index, shown), rateHz, KEEP_S);
  const fullSteps = axis.full_steps_per_rev;
  const microsteps = axis.microsteps_per_full_step ?? 256;
  const microstepsPerTurn = fullSteps * microsteps;
  const maps = useAngleMaps(source, axis.index, fullSteps, microsteps);
  const stops = useStops(at, source, connected);
  const run = useHeldRun(at, source);

  const last = (quantity: string) => (connected ? buffer.last(`${quantity}.${axis.index}`) : Number.NaN);
  const curves: Curve[] = shown.map((which) => ({
    map: maps[which],
    color: colorOf(ENCODERS[which].deviation, scheme),
    label: ENCODERS[which].label,
  }));
  const clear = () => {
    maps.internal.clear();
    maps.external.clear();
  };
  const moving = () => Math.abs(last("velocity")) > 0;
  const stopped = (
    <Card title="What stopped the motor">
      <StopsList stops={stops} />
    </Card>
  );

  return (
    <Page name="Encoder">
      <DeviceNotice device={device} />
      {notice}
      <Card className="pad lines-16 fades" aria-label="Now" data-stale={!connected || link.phase !== "live"}>
        <LiveNumber
          label="Actual"
          unit="µsteps"
          read={() => fixed(last("position"))}
          color={colorOf("position", scheme)}
          testId="actual"
        />
        {shown.map((which) => (
          <LiveNumber
            key={which}
            label={encoderName(which, encoders)}
            unit="µsteps"
            read={() => fixed(last(ENCODERS[which].position))}
            color={colorOf(ENCODERS[which].position, scheme)}
            testId={`encoder-${which}`}
          />
        ))}
        {shown.map((which) => (
          <LiveNumber
            key={which}
            label={shown.length > 1 ? `${ENCODERS[which].label} deviation` : "Deviation"}
            unit="µsteps"
            read={() => fixed(last(ENCODERS[which].deviation))}
            color={colorOf(ENCODERS[which].deviation, scheme)}
            testId={`deviation-${which}`}
          />
        ))}
        {shown.slice(0, 1).map((which) => (
          <LiveNumber
            key={which}
            label="Share of limit"
            unit=""
            read={() => {
              const limit = settings.held(LIMIT[which]);
              if (limit === null) return "–";
              return limit === 0 ? "no limit" : `${fixed((100 * Math.abs(last(ENCODERS[which].deviation))) / limit)} %`;
            }}
          />
        ))}
        <LiveNumber
          label="Shaft"
          unit="°"
          read={() => fixed((turnShare(last("position"), microstepsPerTurn) || 0) * 360, 1)}
        />
        <LiveNumber
          label="Speed"
          unit="rpm"
          read={() => fixed((last("velocity") / microstepsPerTurn) * 60, 1)}
          color={colorOf("velocity", scheme)}
        />
      </Card>
      <div className="live columns side-left until-62">
        <div className="column controls">
          <SlowTurn
            run={run}
            microstepsPerTurn={microstepsPerTurn}
            fullStepsPerTurn={fullSteps}
            accelerationPps2={settings.held(ACCELERATION)}
            rateHz={link.rateHz ?? rateHz}
            disabled={!connected}
          />
          {side({
            shown,
            microstepsPerTurn,
            counted: () => !connected || !Number.isNaN(last(ENCODERS[shown[0] ?? "internal"].position)),
            counter: { actual: () => last("position"), moving, onSet: clear, disabled: !connected },
          })}
          {stopsUnder === "settings" && stopped}
        </div>
        <div className="column">
          <LivePlots
            source={source}
            link={link}
            name={device.name}
            axis={axis.index}
            shown={shown}
            settings={settings}
            stops={stops.data ?? []}
            choices={encoders}
            onShown={setShown}
          />
          <div className={`${classes.lower} columns until-75`}>
            <AngleView
              curves={curves}
              direction={direction}
              onDirection={setDirection}
              shaft={() => turnShare(last("position"), microstepsPerTurn)}
              moving={run.running}
              onClear={clear}
            />
            <div className="column">
              <Harmonics curves={curves} direction={direction} />
              <HistogramView curves={curves} direction={direction} />
            </div>
          </div>
          {stopsUnder === "views" && stopped}
        </div>
      </div>
      {foot}
    </Page>
  );
}

/** Where in its turn a position is, 0..1. */
export function turnShare(position: number, perTurn: number): number {
  return position / perTurn - Math.floor(position / perTurn);
}
