import { Button, Loader, Stack, Text } from "@mantine/core";
import { IconRotateClockwise2 } from "@tabler/icons-react";
import { useState } from "react";
import { Link } from "wouter";
import { type Device, useDevices } from "../../api/queries";
import { EmptyState } from "../../lib/EmptyState";
import { fixed } from "../../lib/format";
import { colorOf } from "../../lib/palette";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { Page, Section } from "../../lib/Section";
import { useScheme } from "../../lib/useScheme";
import { useSelection } from "../../live/selection";
import { useTelemetry } from "../../live/useTelemetry";
import { LiveNumber } from "../module/LiveNumber";
import { StopsList } from "../module/StopsList";
import { useHeldRun } from "../module/useHeldRun";
import { useParameters } from "../module/useParameters";
import { useStops } from "../module/useStops";
import { AngleView } from "./AngleView";
import type { Direction } from "./angleMap";
import classes from "./encoder.module.css";
import { Harmonics } from "./Harmonics";
import { HistogramView } from "./HistogramView";
import { ACCELERATION, Counter, LIMIT, LIMIT_NAMES, Limits } from "./Limits";
import { LivePlots } from "./LivePlots";
import type { Curve } from "./Polar";
import { SlowTurn } from "./SlowTurn";
import { channelsFor, ENCODERS, encodersOf, useAngleMaps, type Which } from "./useEncoder";

/** Odd on purpose: at a round rate and a round speed every turn would be sampled at the same few angles. */
const RATE_HZ = 193.2;
const KEEP_S = 120;

/** What the encoder says of the shaft, against what the motor was told. */
export default function EncoderPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  if (devices.data === undefined && !devices.isError)
    return (
      <Page name="Encoder">
        <Stack align="center" py="xl">
          <Loader aria-label="Looking for devices" />
        </Stack>
      </Page>
    );
  const entry = device?.axes.find((candidate) => candidate.index === axis);
  if (!device || !entry) return <Nothing title="No device" />;
  const encoders = encodersOf(device, axis);
  if (encoders.length === 0)
    return (
      <Page name="Encoder">
        <DeviceNotice device={device} />
        <Nothing title={`No encoder values of ${device.name} yet`} />
      </Page>
    );
  const known: Device = devices.isError ? { ...device, state: "disconnected" } : device;
  return <Encoder key={`${device.id}/${axis}`} device={known} axis={entry} encoders={encoders} />;
}

function Nothing({ title }: { title: string }) {
  return (
    <EmptyState title={title} icon={<IconRotateClockwise2 size={22} />}>
      <Text size="sm" c="dimmed">
        Connect a module, or add an emulated one: that needs no hardware.
      </Text>
      <Button component={Link} href="/connections" size="sm">
        Connections
      </Button>
    </EmptyState>
  );
}

interface Props {
  device: Device;
  axis: Device["axes"][number];
  encoders: readonly Which[];
}

function Encoder({ device, axis, encoders }: Props) {
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
  const parameters = useParameters(at, LIMIT_NAMES, connected);
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

  return (
    <Page name="Encoder">
      <DeviceNotice device={device} />
      <section className={classes.readouts} aria-label="Now" data-stale={!connected || link.phase !== "live"}>
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
            label={`${ENCODERS[which].label} encoder`}
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
              const limit = parameters.held(LIMIT[which]);
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
      </section>
      <div className={classes.page}>
        <div className={classes.side}>
          <SlowTurn
            run={run}
            microstepsPerTurn={microstepsPerTurn}
            fullStepsPerTurn={fullSteps}
            accelerationPps2={parameters.held(ACCELERATION)}
            rateHz={link.rateHz ?? rateHz}
            disabled={!connected}
          />
          <Limits parameters={parameters} shown={shown} microstepsPerTurn={microstepsPerTurn} disabled={!connected} />
          {shown.slice(0, 1).map((which) => (
            <Counter
              key={which}
              parameters={parameters}
              which={which}
              actual={() => last("position")}
              moving={moving}
              onSet={clear}
              disabled={!connected}
            />
          ))}
          <Section title="What stopped the motor">
            <StopsList stops={stops} />
          </Section>
        </div>
        <div className={classes.views}>
          <LivePlots
            source={source}
            link={link}
            name={device.name}
            axis={axis.index}
            shown={shown}
            parameters={parameters}
            stops={stops.data ?? []}
            choices={encoders}
            onShown={setShown}
          />
          <div className={classes.lower}>
            <AngleView
              curves={curves}
              direction={direction}
              onDirection={setDirection}
              shaft={() => turnShare(last("position"), microstepsPerTurn)}
              moving={run.running}
              onClear={clear}
            />
            <div className={classes.numbers}>
              <Harmonics curves={curves} direction={direction} />
              <HistogramView curves={curves} direction={direction} />
            </div>
          </div>
        </div>
      </div>
    </Page>
  );
}

/** Where in its turn a position is, 0..1. */
function turnShare(position: number, perTurn: number): number {
  return position / perTurn - Math.floor(position / perTurn);
}
