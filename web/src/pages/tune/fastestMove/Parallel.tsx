import { compact } from "../../../lib/format";
import { Savable } from "../../../plots/Savable";
import type { Study } from "../study";
import { crossings, rangesOf } from "./trials";
import classes from "./tune.module.css";

interface Props {
  study: Study;
  held: string;
  lost: string;
}

const TOP = 8;
const BOTTOM = 92;

/** Parallel coordinates: a line a trial across all settings and the time; the best is thick. */
export function Parallel({ study, held, lost }: Props) {
  const ranges = rangesOf(study);
  if (ranges.length === 0) return null;
  const x = (index: number) => 4 + (92 * index) / (ranges.length - 1);
  const y = (height: number) => BOTTOM - height * (BOTTOM - TOP);
  return (
    <Savable name="All settings and the time of each trial">
      <figure className={classes.parallel} aria-label="All settings and the time of each trial">
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
