/** The panels of the first page: those that are there without waiting. */
import { Button, Text } from "@mantine/core";
import { IconAdjustmentsAlt } from "@tabler/icons-react";
import { useQueryClient } from "@tanstack/react-query";
import { useContext, useEffect, useMemo } from "react";
import { Link } from "wouter";
import { can, type Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { later } from "../../lib/later";
import { useSelection } from "../../live/selection";
import { AxisTree } from "../../pages/bench/AxisTree";
import classes from "../../pages/bench/bench.module.css";
import { DemoBanner } from "../../pages/bench/DemoBanner";
import { useLiveAxis } from "../../pages/bench/live";
import { MotionCard } from "../../pages/bench/motion/MotionCard";
import { useSearch } from "../../pages/bench/motion/useSearch";
import { StageDrawing } from "../../pages/bench/StageDrawing";
import { ScopeCard } from "../../pages/bench/scope/ScopeCard";
import { useScopeSettings } from "../../pages/bench/scope/settings";
import { useEmulator } from "../../pages/bench/useEmulator";
import { EventsTimeline } from "../../pages/events/EventsTimeline";
import { WorkspaceContext } from "../context";
import type { LooseProps, PanelProps } from "../panel";

const LimitLine = later(() => import("../../pages/bench/LimitLine").then((part) => part.LimitLine));

export function MotionPanel({ device, axis }: LooseProps) {
  const [{ unit }, change] = useScopeSettings();
  if (device && axis)
    return <MotionCard device={device} axis={axis} unit={unit} onUnit={(next) => change({ unit: next })} />;
  return (
    <Card className="pad">
      <Text size="sm" className="dim">
        {device?.name} has no axis: nothing of it moves by itself here. What it holds is on the page{" "}
        <Link href="/registers">Registers</Link>, and any of it on the scope.
      </Text>
    </Card>
  );
}

export function AxesPanel({ devices, lost }: LooseProps) {
  const { device, axis, select } = useSelection();
  const [{ unit }] = useScopeSettings();
  const known = useMemo(
    () => devices.map((each): Device => (lost ? { ...each, state: "disconnected" } : each)),
    [devices, lost],
  );
  return (
    <AxisTree devices={known} selected={device ? { device: device.id, axis } : null} unit={unit} onSelect={select} />
  );
}

export function DemoPanel({ devices }: LooseProps) {
  return <DemoBanner devices={devices} />;
}

export function StagePanel(props: PanelProps) {
  const { device, axis } = props;
  if (!device.emulated && !can(device, "parameters")) return null;
  return <Stage key={`${device.id}/${axis.index}`} {...props} />;
}

const EMULATOR = "emulator";

function Stage({ id, device, axis }: PanelProps) {
  const { document, put } = useContext(WorkspaceContext);
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
  const open = Object.keys(document.panels).find((each) => document.panels[each]?.type === EMULATOR);
  const toggle = async () => {
    const { toggled } = await import("../emulatorAside");
    put(toggled(document, open, id), `The emulator's panel is ${open === undefined ? "at the right" : "closed"}`);
  };
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
          aria-expanded={open !== undefined}
          onClick={() => void toggle()}
          data-testid="emulator-open"
        >
          Emulator
        </Button>
      )}
    </Card>
  );
}

export function LimitsPanel({ device, axis }: PanelProps) {
  const [{ unit }] = useScopeSettings();
  const live = useLiveAxis(device.id, axis.index);
  const limited =
    axis.limit_warnings.length > 0 || Object.values(axis.limits).some((limit) => typeof limit === "number");
  if (!limited) return null;
  return <LimitLine key={`${device.id}/${axis.index}`} device={device} axis={axis} live={live} unit={unit} />;
}

export function ScopePanel({ device, axis, devices }: LooseProps) {
  const id = device?.id ?? "";
  const index = axis?.index ?? 0;
  const main = useMemo(() => ({ device: id, axis: index }), [id, index]);
  const [settings, change] = useScopeSettings();
  if (!device) return null;
  const name = axis ? `${device.name} ${axis.name}` : device.name;
  return (
    <ScopeCard devices={devices} main={main} axisName={name} settings={settings} change={change}>
      {(scope) =>
        axis &&
        can(device, "events") && (
          <div className={classes.events}>
            <EventsTimeline
              key={`${id}/${index}`}
              axis={index}
              device={device}
              name={name}
              source={scope.sources[0]}
              connected={device.state === "connected"}
              window={{ current: () => scope.view.current(), box: scope.timeBox }}
            />
          </div>
        )
      }
    </ScopeCard>
  );
}
