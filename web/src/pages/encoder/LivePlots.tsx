import { SegmentedControl, Switch } from "@mantine/core";
import { useState } from "react";
import { colorOf, lineOf } from "../../lib/palette";
import type { Settings } from "../../lib/rows/settings";
import { useScheme } from "../../lib/useScheme";
import type { LinkState, TelemetrySource } from "../../live/TelemetrySource";
import { Plot } from "../../plots/Plot";
import type { Level, PlotSeries } from "../../plots/types";
import { RollingSection } from "../module/RollingSection";
import { useRolling } from "../module/useRolling";
import { type MotionEnd, stopMarks } from "../module/useStops";
import { LIMIT } from "./settings";
import { ENCODERS, encoderName, type Which } from "./useEncoder";

const SPANS_S = [2, 5, 10, 20, 60] as const;
const FAULT = { light: "#d02828", dark: "#ff6b6b" };

interface Props {
  source: TelemetrySource;
  link: LinkState;
  name: string;
  axis: number;
  shown: readonly Which[];
  /** with it the limits of the deviation are drawn, and dragged */
  settings: Settings | null;
  stops: readonly MotionEnd[];
  choices: readonly Which[];
  onShown: (shown: readonly Which[]) => void;
}

/** Position of motor and encoders over time, and how far they are apart. */
export function LivePlots(props: Props) {
  const { source, link, name, axis, shown, settings, stops, choices, onShown } = props;
  const scheme = useScheme();
  const [toLimit, setToLimit] = useState(false);
  const rolling = useRolling(source, 10);

  const positionTraces = [
    { channel: `position.${axis}`, divisor: 1 },
    ...shown.map((which) => ({ channel: `${ENCODERS[which].position}.${axis}`, divisor: 1 })),
  ];
  const deviationTraces = shown.map((which) => ({ channel: `${ENCODERS[which].deviation}.${axis}`, divisor: 1 }));
  const positionSeries: PlotSeries[] = [
    { label: "actual", color: colorOf("position", scheme), unit: "microsteps" },
    ...shown.map((which) => ({
      label: encoderName(which, choices).toLowerCase(),
      ...lineOf(ENCODERS[which].position, scheme),
      unit: "microsteps",
    })),
  ];
  const deviationSeries = shown.map((which) => ({
    label: choices.length > 1 ? `${ENCODERS[which].label.toLowerCase()} deviation` : "deviation",
    ...lineOf(ENCODERS[which].deviation, scheme),
    unit: "microsteps",
  }));
  const limits = shown.flatMap((which) => {
    const limit = settings?.planned(LIMIT[which]) ?? 0;
    return limit === 0 || settings === null ? [] : [{ which, limit, staged: settings.staged.has(LIMIT[which]) }];
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
  const unwanted = stops.filter(({ reason }) => reason !== "target_reached");
  const marks = () => stopMarks(unwanted, scheme);
  const common = {
    group: "encoder",
    marks,
    onWindow: rolling.changeWindow,
    height: "100%",
  } as const;

  return (
    <RollingSection
      title="Live"
      rolling={rolling}
      link={link}
      name={name}
      spansS={SPANS_S}
      actions={
        <>
          {choices.length > 1 && (
            <SegmentedControl
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
          {settings !== null && (
            <Switch
              label="to the limit"
              wrapperProps={{ title: "Show the deviation up to its limit" }}
              checked={toLimit && widest > 0}
              disabled={widest === 0}
              onChange={(event) => setToLimit(event.currentTarget.checked)}
            />
          )}
        </>
      }
    >
      <div className="strip">
        <Plot
          {...common}
          label="Position of motor and encoder over time"
          series={positionSeries}
          x={{ axis: false }}
          scales={{ y: { unit: "microsteps" } }}
          handle={rolling.plot("position", positionTraces)}
        />
      </div>
      <div className="strip strip-tall">
        <Plot
          {...common}
          label="Deviation over time"
          series={deviationSeries}
          legend
          x={{ label: "time", unit: "s" }}
          scales={{ y: { unit: "microsteps", include: toLimit ? [-widest * 1.08, 0, widest * 1.08] : [0] } }}
          handle={rolling.plot("deviation", deviationTraces)}
          levels={levels}
          onLevel={(id, y) => settings?.stage(LIMIT[id.slice(0, -1) as Which], Math.max(1, Math.round(Math.abs(y))))}
        />
      </div>
    </RollingSection>
  );
}
