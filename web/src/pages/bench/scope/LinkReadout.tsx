import { Text } from "@mantine/core";
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

/** How the samples come: the rate asked for and the one achieved, what was lost, how evenly, how late. */
export function LinkReadout({ name, several, link }: Props) {
  const bad = link.phase !== "live" && link.phase !== "connecting";
  const slow = link.achievedRateHz !== null && link.rateHz !== null && link.achievedRateHz < 0.97 * link.rateHz;
  return (
    <section
      className={`${classes.link} lines-12 baseline shrink text-12`}
      aria-label={`Samples of ${name}`}
      data-testid="link-readout"
    >
      {several && (
        <Text component="span" size="xs" className={`${classes.linkName} clip`}>
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
      <span
        className={`${classes.figure} dim nowrap`}
        data-warn={slow}
        title={`Achieved, of ${fixed(link.rateHz, 0)} Hz granted and ${fixed(link.requestedRateHz, 0)} Hz asked for`}
      >
        <b>{fixed(link.achievedRateHz, 1)}</b> Hz
      </span>
      <span
        className={`${classes.figure} dim nowrap`}
        data-warn={link.dropped > 0}
        title="Samples that the server had to leave out because this page was too slow"
      >
        drops <b>{fixed(link.dropped)}</b>
      </span>
      <span
        className={`${classes.figure} dim nowrap`}
        title={
          link.chipTimed
            ? "How unevenly the samples were taken; their times are the device's own"
            : "How unevenly the samples were taken; their times are the server's"
        }
      >
        jitter <b>{fixed(link.jitterMs, 2)}</b> ms
      </span>
      {link.callsPerS !== null && link.callsPerSPossible !== null && (
        <span
          className={`${classes.figure} dim nowrap`}
          data-testid="wire-budget"
          title="Questions on the wire, of those that it carries a second"
        >
          wire <b>{fixed(link.callsPerS)}</b> of {fixed(link.callsPerSPossible)}/s
        </span>
      )}
      {link.rowSpreadMs !== null && link.rowSpreadMs > 0 && (
        <span
          className={`${classes.figure} dim nowrap`}
          title="From the first to the last question of a row: so far apart are its columns"
        >
          spread <b>{fixed(link.rowSpreadMs, 1)}</b> ms
        </span>
      )}
      <span className={`${classes.figure} dim nowrap`} title="From the sample to its way out to this page">
        latency <b>{fixed(link.latencyMs, 1)}</b> ms
      </span>
    </section>
  );
}
