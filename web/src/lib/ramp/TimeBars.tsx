import { memo, type ReactNode } from "react";
import { Card } from "../Card";
import { fixed } from "../format";
import classes from "./ramp.module.css";
import { share } from "./rivals";
import { time } from "./scales";

export interface TimedRival {
  key: string;
  name: string;
  /** in a sentence, for who asks */
  text?: string;
  seconds: number;
}

interface Props {
  /** of this ramp [s]; null while it is not known */
  seconds: number | null;
  rivals: readonly TimedRival[];
  /** why there is nothing to compare; null where there is */
  why: string | null;
  actions?: ReactNode;
}

/** This ramp beside other ways to make the same move: bars of their times, and what is saved or lost. */
export const TimeBars = memo(function TimeBars({ seconds, rivals, why, actions }: Props) {
  const most = Math.max(seconds ?? 0, ...rivals.map((rival) => rival.seconds));
  return (
    <Card title="Time" {...(actions === undefined ? {} : { actions })}>
      {why !== null || seconds === null || rivals.length === 0 ? (
        <p className="hint m-0">{why ?? "A move from rest is compared with other ways to make it."}</p>
      ) : (
        <ol className={`${classes.bars} list grid text-12`}>
          <Bar name="this ramp" seconds={seconds} most={most} own />
          {rivals.map((rival) => (
            <Bar
              key={rival.key}
              name={rival.name}
              {...(rival.text === undefined ? {} : { title: rival.text })}
              seconds={rival.seconds}
              most={most}
              saved={rival.seconds - seconds}
            />
          ))}
        </ol>
      )}
    </Card>
  );
});

interface BarProps {
  name: string;
  title?: string;
  seconds: number;
  most: number;
  saved?: number;
  own?: boolean;
}

function Bar({ name, title, seconds, most, saved, own = false }: BarProps) {
  return (
    <li title={title}>
      <span>{name}</span>
      <span className={`${classes.barTrack} meter ${own ? "" : "hue-grey"}`} aria-hidden>
        <span style={{ width: `${(seconds / most) * 100}%` }} />
      </span>
      <span className="num">{time(seconds)}</span>
      <span className={`${classes.barNote} dim nowrap`}>{saved === undefined ? "" : savedText(saved, seconds)}</span>
    </li>
  );
}

function savedText(savedS: number, rivalS: number): string {
  const part = Math.abs(share(savedS, rivalS)) * 100;
  if (part < 0.05) return "as fast";
  return `${time(Math.abs(savedS))} (${fixed(part, 1, "%")}) ${savedS > 0 ? "saved" : "longer"}`;
}
