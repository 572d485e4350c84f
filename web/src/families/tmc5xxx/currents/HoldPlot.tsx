import { useMemo } from "react";
import { duration } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import type { Mark } from "../../../plots/types";
import { type HoldDelay, holdLine, holdTimes } from "./hold";

/** how much of the plot's width a name takes, roughly */
const NAME_SHARE = 0.15;

interface Props {
  delay: HoldDelay;
  irun: number;
  ihold: number;
  /** what a scale of 32 is [A rms]: full scale */
  fullScaleA: number;
}

/** The current around a stop: run, wait, and down to hold one step of the scale after the other. */
export function HoldPlot({ delay, irun, ihold, fullScaleA }: Props) {
  const scheme = useScheme();
  const line = useMemo(
    () => holdLine(delay, irun, ihold, (scale) => (fullScaleA * (scale + 1)) / 32),
    [delay, irun, ihold, fullScaleA],
  );
  const times = holdTimes(delay);
  const color = colorOf("current_scale", scheme);
  const grey = scheme === "light" ? "#6b7480" : "#8a929c";
  const mark = (id: string, x: number, label: string, low = false): Mark => ({
    id,
    x,
    color: grey,
    ...(label ? { label } : {}),
    fixed: true,
    low,
  });
  // Right beside "last step" there is no room for its name; the line falls visibly enough.
  const falls = times.fallsS > NAME_SHARE * times.downS ? "falls" : "";
  const marks = [
    mark("stop", 0, "last step"),
    mark("seen", times.seenS, "stands", true),
    ...(delay.waiting_s ? [mark("falls", times.fallsS, falls)] : []),
    ...(times.downS > times.fallsS ? [mark("down", times.downS, "holds", true)] : []),
  ];
  return (
    <Plot
      label="Coil current around a stop"
      summary={`Down to the hold current ${duration(times.downS)} after the last step`}
      series={[{ label: "coil current", unit: "A rms", color, width: 2, fill: `${color}2a` }]}
      data={[line.x, line.y]}
      x={{ label: "after the last step", unit: "s" }}
      scales={{ y: { unit: "A rms", include: [0, fullScaleA] } }}
      marks={marks}
      height={190}
    />
  );
}
