import { compact } from "../../../lib/format";
import { Savable } from "../../../plots/Savable";
import type { Study } from "../study";
import { crossings, type Range, rangesOf } from "./trials";
import classes from "./tune.module.css";

interface Props {
  study: Study;
  held: string;
  lost: string;
  /** axes behind those of the settings; left out: the time */
  figures?: readonly Range[];
}

const TOP = 8;
const BOTTOM = 92;

/** Parallel coordinates: a line a trial across all settings and figures; the best is thick. */
export function Parallel({ study, held, lost, figures }: Props) {
  const ranges = rangesOf(study, figures);
  const label = figures ? "All settings and figures of each trial" : "All settings and the time of each trial";
  if (ranges.length === 0) return null;
  const x = (index: number) => 4 + (92 * index) / (ranges.length - 1);
  const y = (height: number) => BOTTOM - height * (BOTTOM - TOP);
  return (
    <Savable name={label}>
      <figure className={classes.parallel} aria-label={label}>
        <svg viewBox="0 0 100 100" preserveAspectRatio="none" role="presentation">
          {ranges.map(({ name }, index) => (
            <line key={name} x1={x(index)} x2={x(index)} y1={TOP} y2={BOTTOM} className={classes.axis} />
          ))}
          {study.trials
            .filter(({ state }) => state === "feasible" || state === "infeasible")
            .map((trial) => (
              <polyline
                key={trial.number}
                points={crossings(trial, ranges)
                  .map((height, index) => `${x(index)},${y(height)}`)
                  .join(" ")}
                fill="none"
                stroke={trial.state === "feasible" ? held : lost}
                strokeWidth={trial.number === study.best ? 3 : 1}
                strokeOpacity={trial.number === study.best ? 1 : 0.55}
                vectorEffect="non-scaling-stroke"
              />
            ))}
        </svg>
        <figcaption className={classes.names}>
          {ranges.map(({ name, unit, low, high }) => (
            <span key={name}>
              {name}: {compact(low, 3)} to {compact(high, 3)} {unit}
            </span>
          ))}
        </figcaption>
      </figure>
    </Savable>
  );
}
