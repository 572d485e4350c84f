import { ActionIcon, NativeSelect, Select } from "@mantine/core";
import { IconPlayerPause, IconPlayerPlay } from "@tabler/icons-react";
import { memo, useEffect, useMemo, useRef, useState } from "react";
import type { Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { useShared } from "../../lib/shared";
import { useLatest } from "../../lib/useLatest";
import { hub } from "../../live/hub";
import { useFrame } from "../../live/useFrame";
import { FreePlots, type PlotTime } from "../../pages/bench/scope/free/FreePlots";
import classes from "../../pages/bench/scope/free/free.module.css";
import { added, Channels, derivedPath, pathOf } from "../../pages/bench/scope/free/plan";
import { ScopeView } from "../../pages/bench/scope/ScopeView";
import { type FreePlot, type ScopeSettings, SPANS_S, useScopeSettings } from "../../pages/bench/scope/settings";
import { SCOPE, shiftTo } from "../../pages/bench/scope/useScope";
import { Misfit } from "../Misfit";
import type { PanelProps } from "../panel";
import type { PlotConfig } from "./plot";

/** The span of a page without a scope [s]. */
const SPAN_S = 10;
const NO_MARKS = () => () => [];

interface Kind {
  kind: FreePlot["kind"];
  title: string;
  note?: string;
  /** what it shows as long as nobody says otherwise */
  y: readonly string[];
  /** only such channels are offered */
  only?: string;
}

const XY: Kind = { kind: "xy", title: "XY plot", y: ["$:position", "$:velocity"] };
const RESIDUAL: Kind = {
  kind: "time",
  title: "Residual",
  note: "measured less predicted",
  y: ["$:residual"],
  only: "residual",
};

/** Channels over another channel. */
export function XyPanel(props: PanelProps<PlotConfig>) {
  return <PlotOf {...props} {...XY} />;
}

/** How far an axis is from what was predicted for it, over time. */
export function ResidualPanel(props: PanelProps<PlotConfig>) {
  return <PlotOf {...props} {...RESIDUAL} />;
}

function PlotOf({ device, axis, devices, config, change, ...of }: PanelProps<PlotConfig> & Kind) {
  const [{ derived, rateHz }] = useScopeSettings();
  const shared = useShared(SCOPE);
  const inStep = config.spanS === 0 && shared?.links[0]?.timeOriginUnixS != null;
  const own = useTime(device.id, config.spanS || SPAN_S);
  const channels = useMemo(() => new Channels(devices, derived), [devices, derived]);
  const said = config.y.length > 0 ? config.y : of.y;
  const pathFor = (y: string) => (y.startsWith("$:") ? pathOf(device.id, `${y.slice(2)}.${axis.index}`) : y);
  const free: FreePlot[] = [{ id: "1", kind: of.kind, y: [...new Set(said.map(pathFor))] }];
  const content = JSON.stringify(free);
  // biome-ignore lint/correctness/useExhaustiveDependencies: `content` is `free`, compared by content
  const settings = useMemo(() => ({ free, derived, rateHz }), [content, derived, rateHz]);
  const { put } = useLatest({
    put: (y: readonly string[]) => change({ y: y.map((path) => said.find((old) => pathFor(old) === path) ?? path) }),
  });
  const offered = useMemo(() => channelsOffered(devices, derived, of.only), [devices, derived, of.only]);
  const why = `${device.name} tells no ${of.only ?? "such channel"} of ${axis.name}${of.only ? ": nothing is predicted for it." : "."}`;
  if (free[0]?.y.every((path) => channels.unit(path) === null))
    return <Misfit title={of.title} why={device.state === "connected" ? why : `${device.name} is not connected.`} />;
  return (
    <Card
      title={of.title}
      note={device.state === "connected" ? of.note : `${device.name} is not connected: no samples come`}
      className="stack grow pad"
      data-testid={`${of.title} of ${axis.name}`}
      actions={
        <>
          {!inStep && (
            <ActionIcon
              size={28}
              variant="default"
              aria-label={own.paused ? "Go on" : "Hold the picture"}
              onClick={own.paused ? own.run : () => own.pause()}
            >
              {own.paused ? <IconPlayerPlay size={14} /> : <IconPlayerPause size={14} />}
            </ActionIcon>
          )}
          <NativeSelect
            size="xs"
            w={112}
            aria-label="Time"
            value={config.spanS}
            data={[
              { value: "0", label: shared ? "as the scope" : `${SPAN_S} s` },
              ...SPANS_S.filter((span) => shared || span !== SPAN_S).map((span) => ({
                value: String(span),
                label: `${span} s`,
              })),
            ]}
            onChange={(event) => change({ spanS: Number(event.currentTarget.value) })}
          />
          <Add channels={channels} plot={settings.free[0] as FreePlot} offered={offered} put={put} kind={of.kind} />
        </>
      }
    >
      <div className={classes.alone}>
        <FreePlots
          scope={inStep && shared ? shared : own}
          devices={devices}
          settings={settings}
          change={(next) => put(next.free[0]?.y ?? [])}
          alone={of.title}
        />
      </div>
    </Card>
  );
}

/** What a list offers, by device; `only` channels of that quantity. */
function channelsOffered(devices: readonly Device[], derived: ScopeSettings["derived"], only?: string) {
  const fits = ({ quantity }: { quantity: string }) => only === undefined || quantity === only;
  return [
    {
      group: "Derived",
      items: only ? [] : Object.keys(derived).map((name) => ({ value: derivedPath(name), label: name })),
    },
    ...devices.map(({ id, name, channels }) => ({
      group: name,
      items: channels.filter(fits).map((each) => ({
        value: pathOf(id, each.name),
        label: `${name} ${each.name.replaceAll("_", " ")}`,
      })),
    })),
  ];
}

interface AddProps {
  channels: Channels;
  plot: FreePlot;
  kind: FreePlot["kind"];
  offered: ReturnType<typeof channelsOffered>;
  put: (y: readonly string[]) => void;
}

/** Another channel for the plot, and of an XY plot the one that it is over. */
const Add = memo(({ channels, plot, kind, offered, put }: AddProps) => {
  const [refused, setRefused] = useState<string | null>(null);
  const [across, ...up] = plot.y;
  const known = offered.flatMap(({ items }) => items.map(({ value }) => value));
  return (
    <>
      {kind === "xy" && (
        <Select
          size="xs"
          flex="1 1 70px"
          miw={70}
          maw={170}
          aria-label="Over"
          searchable
          limit={80}
          allowDeselect={false}
          data={offered}
          value={across !== undefined && known.includes(across) ? across : null}
          onChange={(path) => path && put([path, ...up.filter((each) => each !== path)])}
        />
      )}
      <Select
        size="xs"
        flex="1 1 70px"
        miw={70}
        maw={170}
        aria-label="Add a channel"
        placeholder="Add…"
        searchable
        limit={80}
        data={offered}
        value={null}
        error={refused}
        onChange={(path) => {
          if (path === null) return;
          const next = added([plot], plot.id, path, channels);
          setRefused("refused" in next ? next.refused : null);
          if ("free" in next) put(next.free[0]?.y ?? []);
        }}
      />
    </>
  );
});

/** The time of a panel that goes by itself: it rolls with its device, and holds what is zoomed into. */
function useTime(device: string, spanS: number): PlotTime & { paused: boolean; run: () => void; pause: () => void } {
  const source = hub.sourceOf(device);
  const [view] = useState(() => new ScopeView(spanS, "roll"));
  const [paused, setPaused] = useState(false);
  const [measured] = useState(() => new Map()); // by nobody: only the scope has a table
  const hover = useRef<number | null>(null);
  useEffect(() => view.set(spanS, "roll"), [view, spanS]);
  useFrame((nowMs) => void view.next(source.buffer.lastTime, nowMs));
  const run = () => {
    view.run();
    setPaused(false);
  };
  const pause = (window?: readonly [number, number]) => {
    view.pause([source], window);
    setPaused(true);
  };
  const shiftOf = useMemo(() => (other: string) => shiftTo(source, other), [source]);
  // another device is another time
  // biome-ignore lint/correctness/useExhaustiveDependencies: the device is what the view looks at
  useEffect(run, [device]);
  return {
    view,
    shiftOf,
    measured,
    marks: NO_MARKS,
    moveMark: () => {},
    changeWindow: (next) => {
      if (next === "reset") run();
      else pause([next.min, next.max]);
      return true;
    },
    hover: () => hover.current,
    setHover: (time) => {
      hover.current = time;
    },
    paused,
    run,
    pause,
  };
}
