import { ActionIcon, Select } from "@mantine/core";
import { IconPlayerPause, IconPlayerPlay } from "@tabler/icons-react";
import { useState } from "react";
import { fixed } from "../../lib/format";
import { colorOf } from "../../lib/palette";
import type { Settings } from "../../lib/rows/settings";
import { Section } from "../../lib/Section";
import { useScheme } from "../../lib/useScheme";
import type { LinkState, TelemetrySource } from "../../live/TelemetrySource";
import { Plot } from "../../plots/Plot";
import type { Level, Mark } from "../../plots/types";
import { LinkReadout } from "../bench/scope/LinkReadout";
import { useRolling } from "../module/useRolling";
import { type MotionEnd, REASONS } from "../module/useStops";
import { type CurrentScale, topOf } from "./load";
import { AP } from "./names";
import classes from "./stallguard.module.css";
import { LOAD_MAX, lowerLoad, upperLoad } from "./thresholds";

const SPANS_S = [5, 10, 20, 60, 120] as const;
const COOL = { light: "#0072b2", dark: "#2d86c4" };
const FAULT = { light: "#d02828", dark: "#ff6b6b" };
const PLAIN = { light: "#6b7480", dark: "#7a828c" };

interface Props {
  source: TelemetrySource;
  link: LinkState;
  name: string;
  axis: number;
  settings: Settings;
  current: CurrentScale;
  /** the driver measures a speed of its own */
  measured: boolean;
  stops: readonly MotionEnd[];
}

/** Load value, current and speed over time. */
export function TimePlots({ source, link, name, axis, settings, current, measured, stops }: Props) {
  const scheme = useScheme();
  const [spanS, setSpanS] = useState(20);
  const rolling = useRolling(source, spanS);
  const cool = { hysteresisStart: settings.planned(AP.coolStart), hysteresis: settings.planned(AP.coolWidth) };
  const levels = [
    { id: "lower", y: lowerLoad(cool) },
    { id: "upper", y: upperLoad(cool) },
  ].flatMap(({ id, y }): Level[] => (y === null ? [] : [{ id, y, color: COOL[scheme], fixed: true }]));
  const marks = (): Mark[] =>
    stops
      .filter((stop) => REASONS[stop.reason].fault)
      .map((stop) => ({
        id: `stop${stop.time_s}`,
        x: stop.time_s,
        color: (REASONS[stop.reason].fault ? FAULT : PLAIN)[scheme],
        label: REASONS[stop.reason].short,
        fixed: true,
      }));
  const common = { group: "stallguard", marks, onWindow: rolling.changeWindow, height: "100%", legend: true } as const;
  const { step, run, symbol } = current;
  return (
    <Section
      title="Over time"
      actions={
        <>
          <Select
            size="xs"
            w={80}
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
        </>
      }
    >
      <LinkReadout name={name} several={false} link={link} />
      <div className={classes.strip}>
        <Plot
          {...common}
          label="Load value over time"
          series={[{ label: "load value", color: colorOf("load_value", scheme) }]}
          x={{ axis: false }}
          scales={{ y: { range: [0, LOAD_MAX + 1] } }}
          levels={levels}
          handle={rolling.plot("load", [{ channel: `load_value.${axis}`, divisor: 1 }])}
        />
      </div>
      <div className={classes.strip}>
        <Plot
          {...common}
          label="Current over time"
          series={[
            {
              label: current.name,
              color: colorOf("actual_current_scale", scheme),
              unit: symbol,
              stepped: true,
            },
          ]}
          x={{ axis: false }}
          scales={{
            y: { unit: symbol, range: [0, topOf(current)] },
            ...(current.shares && Number.isFinite(run) && run > 0
              ? {
                  share: {
                    side: "right" as const,
                    range: [0, 110] as const,
                    ticks: (values: number[]) => values.map((value) => `${fixed(value)} %`),
                  },
                }
              : {}),
          }}
          handle={rolling.plot("current", [
            { channel: `actual_current_scale.${axis}`, divisor: 1 / step, offset: step },
          ])}
        />
      </div>
      <div className={`${classes.strip} ${classes.last}`}>
        <Plot
          {...common}
          label="Speed over time"
          series={[
            { label: "velocity", color: colorOf("velocity", scheme), unit: "pps" },
            ...(measured ? [{ label: "measured", color: colorOf("measured_speed", scheme), unit: "pps" }] : []),
          ]}
          x={{ label: "time", unit: "s" }}
          scales={{ y: { include: [0] } }}
          handle={rolling.plot("speed", [
            { channel: `velocity.${axis}`, divisor: 1 },
            ...(measured ? [{ channel: `measured_speed.${axis}`, divisor: 1 }] : []),
          ])}
        />
      </div>
    </Section>
  );
}
