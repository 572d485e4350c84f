import { Text } from "@mantine/core";
import { type ReactNode, useState } from "react";
import { fixed } from "../../../lib/format";
import type { LinkState } from "../../../live/TelemetrySource";
import classes from "./scope.module.css";

const PHASES: Record<LinkState["phase"], string> = {
  connecting: "connecting",
  live: "live",
  gap: "no samples",
  lost: "reconnecting",
  refused: "refused",
};

interface Props {
  name: string;
  /** other devices are on the scope too: say which this is */
  several: boolean;
  link: LinkState;
}

interface Figure {
  name: string;
  shown: ReactNode;
  means: string;
  warn?: boolean;
}

function figuresOf(link: LinkState): Figure[] {
  const slow = link.achievedRateHz !== null && link.rateHz !== null && link.achievedRateHz < 0.97 * link.rateHz;
  const found: (Figure | false)[] = [
    {
      name: "Hz",
      shown: [<b key="value">{fixed(link.achievedRateHz, 1)}</b>, " Hz"],
      means: `Achieved, of ${fixed(link.rateHz, 0, "Hz")} granted and ${fixed(link.requestedRateHz, 0, "Hz")} asked for`,
      warn: slow,
    },
    {
      name: "drops",
      shown: ["drops ", <b key="value">{fixed(link.dropped)}</b>],
      means: "Samples that the server had to leave out because this page was too slow",
      warn: link.dropped > 0,
    },
    {
      name: "jitter",
      shown: ["jitter ", <b key="value">{fixed(link.jitterMs, 2)}</b>, " ms"],
      means: `How unevenly the samples were taken; their times are the ${link.chipTimed ? "device's own" : "server's"}`,
    },
    link.callsPerS !== null &&
      link.callsPerSPossible !== null && {
        name: "wire",
        shown: ["wire ", <b key="value">{fixed(link.callsPerS)}</b>, ` of ${fixed(link.callsPerSPossible)}/s`],
        means: "Questions on the wire, of those that it carries a second",
      },
    link.rowSpreadMs !== null &&
      link.rowSpreadMs > 0 && {
        name: "spread",
        shown: ["spread ", <b key="value">{fixed(link.rowSpreadMs, 1)}</b>, " ms"],
        means: "From the first to the last question of a row: so far apart are its columns",
      },
    {
      name: "latency",
      shown: ["latency ", <b key="value">{fixed(link.latencyMs, 1)}</b>, " ms"],
      means: "From the sample to its way out to this page",
    },
  ];
  return found.filter((figure) => figure !== false);
}

/** How the samples come, and on request what each figure is: the rate asked for and the one achieved, what was lost, how evenly, how late. */
export function LinkReadout({ name, several, link }: Props) {
  const [explained, setExplained] = useState(false);
  const bad = link.phase !== "live" && link.phase !== "connecting";
  const figures = figuresOf(link);
  return (
    <section
      className={`${classes.link} lines-12 baseline shrink text-12`}
      aria-label={`Samples of ${name}`}
      data-testid="link-readout"
    >
      {several && (
        <Text component="span" size="xs" w="7ch" className="clip">
          {name}
        </Text>
      )}
      <Text component="span" size="xs" fw={600} c={bad ? "red" : "dimmed"} className="nowrap">
        {PHASES[link.phase]}
      </Text>
      {link.reason !== null && (
        <Text component="span" size="xs" c="red" truncate title={link.reason}>
          {link.reason}
        </Text>
      )}
      {figures.map(({ name: figure, shown, warn }) => (
        <span
          key={figure}
          className={`${classes.figure} nowrap ${warn ? "fault" : "dim"}`}
          data-testid={figure === "wire" ? "wire-budget" : undefined}
        >
          {shown}
        </span>
      ))}
      <button
        type="button"
        className="plain"
        style={{ minWidth: 24, cursor: "pointer" }}
        aria-expanded={explained}
        aria-label="What these figures are"
        onClick={() => setExplained(!explained)}
      >
        ?
      </button>
      {explained && (
        <ul className="list m-0 hint" style={{ flexBasis: "100%" }}>
          {figures.map(({ name: figure, means }) => (
            <li key={figure}>
              <b>{figure}</b>: {means}
            </li>
          ))}
        </ul>
      )}
    </section>
  );
}
