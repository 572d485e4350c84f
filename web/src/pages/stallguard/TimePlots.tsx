import { fixed } from "../../lib/format";
import { colorOf } from "../../lib/palette";
import type { Settings } from "../../lib/rows/settings";
import { useScheme } from "../../lib/useScheme";
import type { LinkState, TelemetrySource } from "../../live/TelemetrySource";
import { Plot } from "../../plots/Plot";
import type { Level } from "../../plots/types";
import { RollingSection } from "../module/RollingSection";
import { useRolling } from "../module/useRolling";
import { type MotionEnd, REASONS, stopMarks } from "../module/useStops";
import { type CurrentScale, topOf } from "./load";
import { AP } from "./names";
import { LOAD_MAX, lowerLoad, upperLoad } from "./thresholds";

const SPANS_S = [5, 10, 20, 60, 120] as const;
const COOL = { light: "#0068a8", dark: "#2d86c4" };

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
  const rolling = useRolling(source, 20);
  const cool = { hysteresisStart: settings.planned(AP.coolStart), hysteresis: settings.planned(AP.coolWidth) };
  const levels = [
    { id: "lower", y: lowerLoad(cool) },
    { id: "upper", y: upperLoad(cool) },
  ].flatMap(({ id, y }): Level[] => (y === null ? [] : [{ id, y, color: COOL[scheme], fixed: true }]));
  const faults = stops.filter(({ reason }) => REASONS[reason].fault);
  const marks = () => stopMarks(faults, scheme);
  const common = { group: "stallguard", marks, onWindow: rolling.changeWindow, height: "100%", legend: true } as const;
  const { step, run, symbol } = current;
  return (
    <RollingSection title="Over time" rolling={rolling} link={link} name={name} spansS={SPANS_S}>
      <div className="strip">
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
      <div className="strip">
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
                    ticks: (values: number[]) => values.map((value) => fixed(value, 0, "%")),
                  },
                }
              : {}),
          }}
          handle={rolling.plot("current", [
            { channel: `actual_current_scale.${axis}`, divisor: 1 / step, offset: step },
          ])}
        />
      </div>
      <div className="strip strip-tall">
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
    </RollingSection>
  );
}
