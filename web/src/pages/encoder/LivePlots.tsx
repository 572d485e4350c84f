import { ActionIcon, Group, SegmentedControl, Select, Switch } from "@mantine/core";
import { IconPlayerPause, IconPlayerPlay } from "@tabler/icons-react";
import { useState } from "react";
import { colorOf } from "../../lib/palette";
import type { Settings } from "../../lib/rows/settings";
import { Section } from "../../lib/Section";
import { useScheme } from "../../lib/useScheme";
import type { LinkState, TelemetrySource } from "../../live/TelemetrySource";
import { Plot } from "../../plots/Plot";
import type { Level, Mark, PlotSeries } from "../../plots/types";
import { LinkReadout } from "../bench/scope/LinkReadout";
import { useRolling } from "../module/useRolling";
import { type MotionEnd, REASONS } from "../module/useStops";
import classes from "./encoder.module.css";
import { LIMIT } from "./settings";
import { ENCODERS, encoderName, type Which } from "./useEncoder";

const SPANS_S = [2, 5, 10, 20, 60] as const;
const FAULT = { light: "#d02828", dark: "#ff6b6b" };
const PLAIN = { light: "#6b7480", dark: "#7a828c" };

interface Props {
  source: TelemetrySource;
  link: LinkState;
  name: string;
  axis: number;
  shown: readonly Which[];
  settings: Settings;
  stops: readonly MotionEnd[];
  choices: readonly Which[];
  onShown: (shown: readonly Which[]) => void;
}

/** Position of motor and encoders over time, and how far they are apart. */
export function LivePlots(props: Props) {
  const { source, link, name, axis, shown, settings, stops, choices, onShown } = props;
  const scheme = useScheme();
  const [spanS, setSpanS] = useState(10);
  const [toLimit, setToLimit] = useState(false);
  const rolling = useRolling(source, spanS);

  const positionTraces = [
    { channel: `position.${axis}`, divisor: 1 },
    ...shown.map((which) => ({ channel: `${ENCODERS[which].position}.${axis}`, divisor: 1 })),
  ];
  const deviationTraces = shown.map((which) => ({ channel: `${ENCODERS[which].deviation}.${axis}`, divisor: 1 }));
  const positionSeries: PlotSeries[] = [
    { label: "actual", color: colorOf("position", scheme), unit: "microsteps" },
    ...shown.map((which) => ({
      label: encoderName(which, choices).toLowerCase(),
      color: colorOf(ENCODERS[which].position, scheme),
      unit: "microsteps",
    })),
  ];
  const deviationSeries = shown.map((which) => ({
    label: choices.length > 1 ? `${ENCODERS[which].label.toLowerCase()} deviation` : "deviation",
    color: colorOf(ENCODERS[which].deviation, scheme),
    unit: "microsteps",
  }));
  const limits = shown.flatMap((which) => {
    const limit = settings.planned(LIMIT[which]);
    return limit === null || limit === 0 ? [] : [{ which, limit, staged: settings.staged.has(LIMIT[which]) }];
  });
  const levels = limits.flatMap(({ which, limit, staged }): Level[] =>
    [limit, -limit].map((y) => ({
      id: `${which}${y < 0 ? "-" : "+"}`,
      y,
      color: staged ? colorOf(ENCODERS[which].deviation, scheme) : FAULT[scheme],
      label: `${shown.length > 1 ? `${ENCODERS[which].label.toLowerCase()} ` : ""}limit${staged ? ", not applied" : ""}`,
    })),
  );
  const widest = Math.max(0, ...limits.map(({ limit }) => limit));
  const marks = (): Mark[] =>
    stops
      .filter((stop) => stop.reason !== "target_reached")
      .map((stop) => ({
        id: `stop${stop.time_s}`,
        x: stop.time_s,
        color: (REASONS[stop.reason].fault ? FAULT : PLAIN)[scheme],
        label: REASONS[stop.reason].short,
        fixed: true,
      }));
  const common = {
    group: "encoder",
    marks,
    onWindow: rolling.changeWindow,
    height: "100%",
  } as const;

  return (
    <Section
      title="Live"
      className={classes.live}
      actions={
        <Group gap={6}>
          {choices.length > 1 && (
            <SegmentedControl
              size="xs"
              aria-label="Encoder"
              data={[
                ...choices.map((which) => ({ value: which as string, label: ENCODERS[which].label })),
                { value: "both", label: "Both" },
              ]}
              value={shown.length > 1 ? "both" : (shown[0] ?? "internal")}
              onChange={(value) => onShown(value === "both" ? choices : [value as Which])}
              data-testid="which-encoder"
            />
          )}
          <Switch
            size="xs"
            label="to the limit"
            wrapperProps={{ title: "Show the deviation up to its limit" }}
            checked={toLimit && widest > 0}
            disabled={widest === 0}
            onChange={(event) => setToLimit(event.currentTarget.checked)}
          />
          <Select
            size="xs"
            w={76}
            aria-label="Time span"
            data={SPANS_S.map((span) => ({ value: String(span), label: `${span} s` }))}
            value={String(spanS)}
            allowDeselect={false}
            onChange={(value) => value && setSpanS(Number(value))}
          />
          <ActionIcon
            variant={rolling.paused ? "filled" : "default"}
            size={30}
            aria-label={rolling.paused ? "Run" : "Pause"}
            onClick={() => (rolling.paused ? rolling.run() : rolling.pause())}
          >
            {rolling.paused ? <IconPlayerPlay size={16} /> : <IconPlayerPause size={16} />}
          </ActionIcon>
        </Group>
      }
    >
      <LinkReadout name={name} several={false} link={link} />
      <div className={classes.strip}>
        <Plot
          {...common}
          label="Position of motor and encoder over time"
          series={positionSeries}
          x={{ axis: false }}
          scales={{ y: { unit: "microsteps" } }}
          handle={rolling.plot("position", positionTraces)}
        />
      </div>
      <div className={classes.strip}>
        <Plot
          {...common}
          label="Deviation over time"
          series={deviationSeries}
          legend
          x={{ label: "time", unit: "s" }}
          scales={{ y: { unit: "microsteps", include: toLimit ? [-widest * 1.08, 0, widest * 1.08] : [0] } }}
          handle={rolling.plot("deviation", deviationTraces)}
          levels={levels}
          onLevel={(id, y) => settings.stage(LIMIT[id.slice(0, -1) as Which], Math.max(1, Math.round(Math.abs(y))))}
        />
      </div>
    </Section>
  );
}
