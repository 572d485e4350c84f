import type { Schemas } from "../../../api/client";
import { compact, frequency, withUnit } from "../../../lib/format";

type Figure = Schemas["ChopperFigure"];

/** One line of what follows: a figure, and the same in other units beside it. */
export interface FigureLine {
  name: string;
  label: string;
  values: string[];
  reason: string;
  source: string;
}

/** A speed is told three times: in pps, in rpm and as TSTEP. That is one line. */
const OTHER_UNITS = /_(rpm|tstep)$/;

export function figureLines(figures: readonly Figure[]): FigureLine[] {
  const lines: FigureLine[] = [];
  for (const figure of figures) {
    const text = figureText(figure);
    const line = lines.find(({ name }) => name === figure.name.replace(OTHER_UNITS, ""));
    if (line && OTHER_UNITS.test(figure.name)) line.values.push(text);
    else
      lines.push({
        name: figure.name,
        label: figure.label,
        values: [text],
        reason: figure.reason,
        source: figure.source,
      });
  }
  return lines;
}

function figureText({ value, unit }: Figure): string {
  if (unit === "Hz") return frequency(value);
  if (unit === "pps") return compact(Math.round(value), 4, "pps");
  if (unit === "clocks") return `TSTEP ${compact(value)}`;
  return withUnit(value, unit, 3);
}

/** Where the motor's speed ends, for the axis of speeds: by name, in pps. */
export interface SpeedLimit {
  name: string;
  pps: number;
}

const LIMITS: Readonly<Record<string, string>> = {
  current_limit: "full current ends",
  stealthchop_limit: "StealthChop ends",
};

export function speedLimits(figures: readonly Figure[]): SpeedLimit[] {
  return figures.flatMap(({ name, value }) => {
    const told = LIMITS[name];
    return told === undefined || !(value > 0) ? [] : [{ name: told, pps: value }];
  });
}
