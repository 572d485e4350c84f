import { Button, Text, VisuallyHidden } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { IconAdjustmentsAlt, IconPlugConnected } from "@tabler/icons-react";
import { useQueryClient } from "@tanstack/react-query";
import { useEffect, useMemo } from "react";
import { Link } from "wouter";
import { can, type Device, useDevices } from "../../api/queries";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { later } from "../../lib/later";
import { useSelection } from "../../live/selection";
import { EventsTimeline } from "../events/EventsTimeline";
import { AxisTree } from "./AxisTree";
import classes from "./bench.module.css";
import { DemoBanner } from "./DemoBanner";
import { BenchLive, useLiveAxis } from "./live";
import { MotionCard } from "./motion/MotionCard";
import { useSearch } from "./motion/useSearch";
import { StageDrawing } from "./StageDrawing";
import { ScopeCard } from "./scope/ScopeCard";
import { putSettings, useScopeSettings } from "./scope/settings";
import { useEmulator } from "./useEmulator";

const EmulatorPanel = later(() => import("./EmulatorPanel").then((part) => part.EmulatorPanel));
const LimitLine = later(() => import("./LimitLine").then((part) => part.LimitLine));

/** All axes at a glance, one in the hand, and the scope on it. */
export default function BenchPage() {
  const devices = useDevices();
  if (devices.data === undefined) return devices.isError ? null : <Skeleton />;
  if (devices.data.length === 0)
    return (
      <EmptyState title="No device yet" icon={<IconPlugConnected size={22} />}>
        <Text size="sm">Add a chip on a TCP link, or an emulated one.</Text>
        <Button component={Link} href="/connections" size="sm">
          Add a device
        </Button>
      </EmptyState>
    );
  return (
    <BenchLive>
      <Bench devices={devices.data} lost={devices.isError} />
    </BenchLive>
  );
}

/** The bench's boxes while nobody knows yet what is in them: each already where it will be. */
function Skeleton() {
  return (
    <div className={classes.bench} role="status" aria-label="Looking for devices">
      <div className={`${classes.side} stack shrink gap-8`}>
        <Card as="div" className={`${classes.card} stack gap-8`} data-skeleton />
        <Card as="div" className={classes.tree} data-skeleton />
      </div>
      <div className={`${classes.stageAndScope} stack shrink gap-8`}>
        <Card as="div" className={`${classes.stageBox} flex start rigid`} data-skeleton />
        <Card as="div" className={`${classes.scopeSkeleton} grow`} />
      </div>
    </div>
  );
}

interface BenchProps {
  devices: readonly Device[];
  /** the server does not answer: nobody knows how the devices are */
  lost: boolean;
}

function Bench({ devices, lost }: BenchProps) {
  const { device, axis, select } = useSelection();
  const [settings, change] = useScopeSettings();
  // biome-ignore lint/correctness/useExhaustiveDependencies: as it was left; each change of it says so by itself
  useEffect(() => putSettings(settings), []);
  const [panel, { toggle, close }] = useDisclosure();
  const asKnown = (each: Device): Device => (lost ? { ...each, state: "disconnected" } : each);
  const entry = device?.axes.find((candidate) => candidate.index === axis) ?? device?.axes[0];
  const deviceId = device?.id ?? "";
  const main = useMemo(() => ({ device: deviceId, axis }), [deviceId, axis]);
  return (
    <div className={classes.bench} data-panel={device?.emulated === true && panel}>
      <VisuallyHidden>
        <h1>Bench</h1>
      </VisuallyHidden>
      <div className={`${classes.side} stack shrink gap-8`}>
        {device && entry && (
          <MotionCard device={asKnown(device)} axis={entry} unit={settings.unit} onUnit={(unit) => change({ unit })} />
        )}
        <AxisTree
          devices={devices.map(asKnown)}
          selected={device ? { device: device.id, axis } : null}
          unit={settings.unit}
          onSelect={select}
        />
      </div>
      <div className={`${classes.stageAndScope} stack shrink gap-8`}>
        <DemoBanner devices={devices} />
        {device && !entry && (
          <>
            <Card className="pad">
              <Text size="sm" className="dim">
                {device.name} has no axis: nothing of it moves by itself here. What it holds is on the page{" "}
                <Link href="/registers">Registers</Link>, and any of it on the scope.
              </Text>
            </Card>
            <ScopeCard devices={devices} main={main} axisName={device.name} settings={settings} change={change} />
          </>
        )}
        {device && entry && (
          <>
            {(device.emulated || can(device, "parameters")) && (
              <Stage
                key={`${device.id}/${axis}`}
                device={asKnown(device)}
                axis={entry}
                open={panel}
                onToggle={toggle}
              />
            )}
            <Limits key={`limits/${device.id}/${axis}`} device={asKnown(device)} axis={entry} unit={settings.unit} />
            <ScopeCard
              devices={devices}
              main={main}
              axisName={`${device.name} ${entry.name}`}
              settings={settings}
              change={change}
            >
              {(scope) =>
                can(device, "events") && (
                  <div className={classes.events}>
                    <EventsTimeline
                      key={`${device.id}/${entry.index}`}
                      axis={entry.index}
                      device={device}
                      name={`${device.name} ${entry.name}`}
                      source={scope.sources[0]}
                      connected={asKnown(device).state === "connected"}
                      window={{ current: () => scope.view.current(), box: scope.timeBox }}
                    />
                  </div>
                )
              }
            </ScopeCard>
          </>
        )}
      </div>
      {device?.emulated && panel && (
        <EmulatorPanel device={device} axis={axis} onAxis={(next) => select(device.id, next)} onClose={close} />
      )}
    </div>
  );
}

function Limits({ device, axis, unit }: { device: Device; axis: Device["axes"][number]; unit: string }) {
  const live = useLiveAxis(device.id, axis.index);
  const limited =
    axis.limit_warnings.length > 0 || Object.values(axis.limits).some((limit) => typeof limit === "number");
  return limited && <LimitLine device={device} axis={axis} live={live} unit={unit} />;
}

interface StageProps {
  device: Device;
  axis: Device["axes"][number];
  open: boolean;
  onToggle: () => void;
}

function Stage({ device, axis, open, onToggle }: StageProps) {
  const emulator = useEmulator(device);
  const live = useLiveAxis(device.id, axis.index);
  const drawn = can(device, "parameters") || can(device, "stallguard");
  const search = useSearch({ device: device.id, axis: axis.index }, drawn && device.state === "connected");
  const queries = useQueryClient();
  const searched = search.data?.state;
  // with the search's end the counter has another zero: the drawing has to learn where that is
  // biome-ignore lint/correctness/useExhaustiveDependencies: it is the state that ends
  useEffect(
    () => void queries.invalidateQueries({ queryKey: ["emulator", device.id] }),
    [queries, searched, device.id],
  );
  return (
    <Card as="div" className={`${classes.stageBox} flex start rigid`}>
      <StageDrawing device={device} axis={axis} live={live} emulator={emulator.data} search={search.data} />
      {device.emulated && (
        <Button
          size="compact-xs"
          variant="subtle"
          flex="none"
          m={4}
          leftSection={<IconAdjustmentsAlt size={14} aria-hidden />}
          aria-expanded={open}
          onClick={onToggle}
          data-testid="emulator-open"
        >
          Emulator
        </Button>
      )}
    </Card>
  );
}
