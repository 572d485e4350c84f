import { type ReactNode, useMemo, useRef } from "react";
import type { Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { Page } from "../../lib/Page";
import { colorOf, type Quantity } from "../../lib/palette";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import type { Settings } from "../../lib/rows/settings";
import { useScheme } from "../../lib/useScheme";
import { useFrame } from "../../live/useFrame";
import { useTelemetry } from "../../live/useTelemetry";
import { LiveNumber } from "../module/LiveNumber";
import { StopsList } from "../module/StopsList";
import { useHeldRun } from "../module/useHeldRun";
import { useStops } from "../module/useStops";
import { type CurrentScale, currentOf } from "./load";
import { type Line, SpeedPlot } from "./SpeedPlot";
import { SweepSection } from "./SweepSection";
import { SpeedMap } from "./speedMap";
import { TimePlots } from "./TimePlots";
import { type SpeedLimits, type Zone, zoneAt } from "./thresholds";

const RATE_HZ = 100;
const KEEP_S = 120;
const QUANTITIES: readonly Quantity[] = ["velocity", "measured_speed", "load_value", "actual_current_scale"];

interface Props {
  device: Device;
  axis: Device["axes"][number];
  settings: Settings;
  current: CurrentScale;
  /** limits between the driver's modes; null while speeds are not in pps */
  limits: SpeedLimits | null;
  zones: Record<Zone, string>;
  lines: Partial<Record<Line, string>> | null;
  /** of the axis' ramp; null while unknown */
  accelerationPps2: number | null;
  /** the settings, to be changed */
  thresholds: ReactNode;
  /** above everything */
  notice?: ReactNode;
  /** below everything */
  foot?: ReactNode;
}

/** How hard the motor works: load value and current, over time and over speed, and where their thresholds lie. */
export function LoadView(props: Props) {
  const { device, axis, settings, current, limits } = props;
  const scheme = useScheme();
  const at = { device: device.id, axis: axis.index };
  const connected = device.state === "connected";
  const channels = QUANTITIES.map((quantity) => `${quantity}.${axis.index}`).filter((name) =>
    device.channels.some((channel) => channel.name === name),
  );
  const { source, link, buffer } = useTelemetry(device.id, channels, Math.min(RATE_HZ, device.rate_max_hz), KEEP_S);
  const stops = useStops(at, source, connected);
  const run = useHeldRun(at, source);
  const microstepsPerTurn = axis.full_steps_per_rev * (axis.microsteps_per_full_step ?? 256);
  // biome-ignore lint/correctness/useExhaustiveDependencies: what was gathered belongs to one axis of one device
  const map = useMemo(() => new SpeedMap(), [device.id, axis.index]);
  const of = (quantity: Quantity) => `${quantity}.${axis.index}`;
  const measured = channels.includes(of("measured_speed"));
  const speed: Quantity = measured ? "measured_speed" : "velocity";

  const seen = useRef(-1);
  useFrame(() => {
    if (seen.current === buffer.revision) return;
    seen.current = buffer.revision;
    map.read(buffer, {
      speed: of(speed),
      load: of("load_value"),
      scale: of("actual_current_scale"),
      velocity: of("velocity"),
    });
  });

  const last = (quantity: Quantity) => (connected ? buffer.last(of(quantity)) : Number.NaN);
  const zone = () => {
    const now = last(speed);
    if (Number.isNaN(now) || limits === null) return "–";
    return props.zones[zoneAt(last("velocity") === 0 ? 0 : now, limits)];
  };

  return (
    <Page name="StallGuard">
      <DeviceNotice device={device} />
      {props.notice}
      <Card className="pad lines-16 fades" aria-label="Now" data-stale={!connected || link.phase !== "live"}>
        <LiveNumber
          label="Load value"
          unit="of 1023"
          read={() => fixed(last("load_value"))}
          color={colorOf("load_value", scheme)}
          testId="load"
        />
        <LiveNumber
          label="Current"
          unit={current.unit}
          read={() => fixed(currentOf(last("actual_current_scale"), current), current.decimals)}
          color={colorOf("actual_current_scale", scheme)}
          testId="current"
        />
        <LiveNumber
          label="of run current"
          unit="%"
          read={() => fixed((100 * currentOf(last("actual_current_scale"), current)) / current.run)}
        />
        {measured && (
          <LiveNumber
            label="Measured speed"
            unit="pps"
            read={() => fixed(last("measured_speed"))}
            color={colorOf("measured_speed", scheme)}
          />
        )}
        {!measured && (
          <LiveNumber
            label="Velocity"
            unit="pps"
            read={() => fixed(last("velocity"))}
            color={colorOf("velocity", scheme)}
          />
        )}
        <LiveNumber
          label="Speed"
          unit="rpm"
          read={() => fixed((last("velocity") / microstepsPerTurn) * 60, 1)}
          testId="speed"
        />
        <LiveNumber label="Mode by speed" unit="" read={zone} />
      </Card>
      <div className="live columns side-left until-62">
        <div className="column controls">
          <SweepSection
            run={run}
            microstepsPerTurn={microstepsPerTurn}
            accelerationPps2={props.accelerationPps2}
            disabled={!connected}
          />
          {props.thresholds}
        </div>
        <div className="column">
          <SpeedPlot
            map={map}
            settings={settings}
            current={current}
            lines={props.lines}
            now={() => ({ speed: last(speed), load: last("load_value") })}
          />
          <TimePlots
            source={source}
            link={link}
            name={device.name}
            axis={axis.index}
            settings={settings}
            current={current}
            measured={measured}
            stops={stops.data ?? []}
          />
          <Card title="What stopped the motor">
            <StopsList stops={stops} />
          </Card>
        </div>
      </div>
      {props.foot}
    </Page>
  );
}
