import { Button, Loader, Stack, Text } from "@mantine/core";
import { IconGauge } from "@tabler/icons-react";
import { useMemo, useRef } from "react";
import { Link } from "wouter";
import { type Device, useDevices } from "../../api/queries";
import { EmptyState } from "../../lib/EmptyState";
import { fixed } from "../../lib/format";
import { colorOf, type Quantity } from "../../lib/palette";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { Page, Section } from "../../lib/Section";
import { useScheme } from "../../lib/useScheme";
import { useSelection } from "../../live/selection";
import { useFrame } from "../../live/useFrame";
import { useTelemetry } from "../../live/useTelemetry";
import { LiveNumber } from "../module/LiveNumber";
import { StopsList } from "../module/StopsList";
import { useHeldRun } from "../module/useHeldRun";
import { useParameters } from "../module/useParameters";
import { useStops } from "../module/useStops";
import { AP, NAMES } from "./names";
import { SpeedPlot } from "./SpeedPlot";
import { SweepSection } from "./SweepSection";
import { SpeedMap } from "./speedMap";
import classes from "./stallguard.module.css";
import { Thresholds } from "./Thresholds";
import { TimePlots } from "./TimePlots";
import { currentA, shareOfRun, type Zone, zoneAt } from "./thresholds";

const RATE_HZ = 100;
const KEEP_S = 120;
const QUANTITIES: readonly Quantity[] = ["velocity", "measured_speed", "load_value", "actual_current_scale"];
const ZONES: Record<Zone, string> = {
  stealthchop: "StealthChop",
  spreadcycle: "SpreadCycle",
  coolstep: "CoolStep",
  "high speed": "above AP 22",
};

/** How hard the motor works: load value, current, and where their thresholds lie. */
export default function StallGuardPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  if (devices.data === undefined && !devices.isError)
    return (
      <Page name="StallGuard">
        <Stack align="center" py="xl">
          <Loader aria-label="Looking for devices" />
        </Stack>
      </Page>
    );
  const entry = device?.axes.find((candidate) => candidate.index === axis);
  if (!device || !entry) return <Nothing title="No device" />;
  if (!device.channels.some((channel) => channel.name === `load_value.${axis}`))
    return (
      <Page name="StallGuard">
        <DeviceNotice device={device} />
        <Nothing title={`No load values of ${device.name} yet`} />
      </Page>
    );
  const known: Device = devices.isError ? { ...device, state: "disconnected" } : device;
  return <Load key={`${device.id}/${axis}`} device={known} axis={entry} />;
}

function Nothing({ title }: { title: string }) {
  return (
    <EmptyState title={title} icon={<IconGauge size={22} />}>
      <Text size="sm" c="dimmed">
        Connect a module, or add an emulated one: that needs no hardware.
      </Text>
      <Button component={Link} href="/connections" size="sm">
        Connections
      </Button>
    </EmptyState>
  );
}

function Load({ device, axis }: { device: Device; axis: Device["axes"][number] }) {
  const scheme = useScheme();
  const at = { device: device.id, axis: axis.index };
  const connected = device.state === "connected";
  const channels = QUANTITIES.map((quantity) => `${quantity}.${axis.index}`).filter((name) =>
    device.channels.some((channel) => channel.name === name),
  );
  const { source, link, buffer } = useTelemetry(device.id, channels, Math.min(RATE_HZ, device.rate_max_hz), KEEP_S);
  const parameters = useParameters(at, NAMES, connected);
  const stops = useStops(at, source, connected);
  const run = useHeldRun(at, source);
  const microstepsPerTurn = axis.full_steps_per_rev * (axis.microsteps_per_full_step ?? 256);
  // biome-ignore lint/correctness/useExhaustiveDependencies: what was gathered belongs to one axis of one device
  const map = useMemo(() => new SpeedMap(), [device.id, axis.index]);

  const seen = useRef(-1);
  useFrame(() => {
    if (seen.current === buffer.revision) return;
    seen.current = buffer.revision;
    const of = (quantity: Quantity) => `${quantity}.${axis.index}`;
    map.read(buffer, {
      speed: of("measured_speed"),
      load: of("load_value"),
      scale: of("actual_current_scale"),
      velocity: of("velocity"),
    });
  });

  const last = (quantity: Quantity) => (connected ? buffer.last(`${quantity}.${axis.index}`) : Number.NaN);
  const held = parameters.held;
  const current = { run: held(AP.runCurrent), scaler: held(AP.scaler) };
  const zone = () => {
    const speed = last("measured_speed");
    if (Number.isNaN(speed) || held(AP.unitMode) !== 1) return "–";
    return ZONES[
      zoneAt(last("velocity") === 0 ? 0 : speed, {
        stealth: held(AP.stealthBelow),
        stealthOn: (held(AP.stealthGradient) ?? 0) > 0,
        coolOn: held(AP.coolOn),
        coolOff: held(AP.coolOff),
        coolStepOn: (held(AP.coolStart) ?? 0) > 0,
      })
    ];
  };

  return (
    <Page name="StallGuard">
      <DeviceNotice device={device} />
      <section className={classes.readouts} aria-label="Now" data-stale={!connected || link.phase !== "live"}>
        <LiveNumber
          label="Load value"
          unit="of 1023"
          read={() => fixed(last("load_value"))}
          color={colorOf("load_value", scheme)}
          testId="load"
        />
        <LiveNumber
          label="Current"
          unit="A rms"
          read={() => fixed(currentA(last("actual_current_scale"), current.scaler), 2)}
          color={colorOf("actual_current_scale", scheme)}
          testId="current"
        />
        <LiveNumber
          label="of run current"
          unit="%"
          read={() => fixed(100 * shareOfRun(last("actual_current_scale"), current))}
        />
        <LiveNumber
          label="Measured speed"
          unit="pps"
          read={() => fixed(last("measured_speed"))}
          color={colorOf("measured_speed", scheme)}
        />
        <LiveNumber label="Speed" unit="rpm" read={() => fixed((last("velocity") / microstepsPerTurn) * 60, 1)} />
        <LiveNumber label="Mode by speed" unit="" read={zone} />
      </section>
      <div className={classes.page}>
        <div className={classes.side}>
          <SweepSection
            run={run}
            microstepsPerTurn={microstepsPerTurn}
            accelerationPps2={held(AP.unitMode) === 1 ? held(AP.acceleration) : null}
            disabled={!connected}
          />
          <Thresholds parameters={parameters} disabled={!connected} />
        </div>
        <div className={classes.views}>
          <SpeedPlot
            map={map}
            parameters={parameters}
            now={() => ({ speed: last("measured_speed"), load: last("load_value") })}
          />
          <TimePlots
            source={source}
            link={link}
            name={device.name}
            axis={axis.index}
            parameters={parameters}
            stops={stops.data ?? []}
          />
          <Section title="What stopped the motor">
            <StopsList stops={stops} />
          </Section>
        </div>
      </div>
    </Page>
  );
}
