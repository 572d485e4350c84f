import { memo } from "react";
import { fixed } from "../../lib/format";
import { Section } from "../../lib/Section";
import type { Answer } from "./design";
import { share } from "./rivals";
import { time } from "./scales";
import classes from "./sramp.module.css";

const NAMES: Record<string, string> = {
  trapezoid: "trapezoid, same limits",
  motor_trapezoid: "trapezoid the motor can follow",
  motor_limit: "what the motor could do",
};

/** This ramp beside other ways to make the same move: bars of their times, and what is saved or lost. */
export const TimeSection = memo(function TimeSection({
  answer,
  why,
}: {
  answer: Answer | undefined;
  why: string | null;
}) {
  const rivals = answer?.rivals ?? [];
  const most = Math.max(answer?.duration_s ?? 0, ...rivals.map((rival) => rival.duration_s));
  return (
    <Section title="Time">
      {why !== null || !answer || rivals.length === 0 ? (
        <p className={classes.hint}>{why ?? "A move from rest is compared with other ways to make it."}</p>
      ) : (
        <ol className={classes.bars}>
          <Bar name="this ramp" seconds={answer.duration_s} most={most} own />
          {rivals.map((rival) => (
            <Bar
              key={rival.name}
              name={NAMES[rival.name] ?? rival.name}
              title={rival.text}
              seconds={rival.duration_s}
              most={most}
              saved={rival.saved_s}
            />
          ))}
        </ol>
      )}
    </Section>
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
      <span className={classes.barName}>{name}</span>
      <span className={classes.barTrack} aria-hidden>
        <span className={classes.bar} data-own={own || undefined} style={{ width: `${(seconds / most) * 100}%` }} />
      </span>
      <span className="num">{time(seconds)}</span>
      <span className={classes.barNote}>{saved === undefined ? "" : savedText(saved, seconds)}</span>
    </li>
  );
}

function savedText(savedS: number, rivalS: number): string {
  const part = Math.abs(share(savedS, rivalS)) * 100;
  if (part < 0.05) return "as fast";
  return `${time(Math.abs(savedS))} (${fixed(part, 1)} %) ${savedS > 0 ? "saved" : "longer"}`;
}
