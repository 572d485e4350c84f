import { Text, Tooltip } from "@mantine/core";
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
    <section className={classes.link} aria-label={`Samples of ${name}`} data-testid="link-readout">
      {several && (
        <Text component="span" size="xs" className={classes.linkName}>
          {name}
        </Text>
      )}
      <Text component="span" size="xs" fw={600} c={bad ? "red" : "dimmed"} className={classes.phase}>
        {PHASES[link.phase]}
      </Text>
      {link.reason !== null && (
        <Text component="span" size="xs" c="red" truncate title={link.reason}>
          {link.reason}
        </Text>
      )}
      <Tooltip
        label={`Achieved, of ${fixed(link.rateHz, 0)} Hz granted and ${fixed(link.requestedRateHz, 0)} Hz asked for`}
      >
        <span className={classes.figure} data-warn={slow}>
          <b>{fixed(link.achievedRateHz, 1)}</b> Hz
        </span>
      </Tooltip>
      <Tooltip label="Samples that the server had to leave out because this page was too slow">
        <span className={classes.figure} data-warn={link.dropped > 0}>
          drops <b>{fixed(link.dropped)}</b>
        </span>
      </Tooltip>
      <Tooltip
        label={
          link.chipTimed
            ? "How unevenly the samples were taken; their times are the device's own"
            : "How unevenly the samples were taken; their times are the server's"
        }
      >
        <span className={classes.figure}>
          jitter <b>{fixed(link.jitterMs, 2)}</b> ms
        </span>
      </Tooltip>
      {link.callsPerS !== null && link.callsPerSPossible !== null && (
        <Tooltip label="Questions on the wire, of those that it carries a second">
          <span className={classes.figure} data-testid="wire-budget">
            wire <b>{fixed(link.callsPerS)}</b> of {fixed(link.callsPerSPossible)}/s
          </span>
        </Tooltip>
      )}
      {link.rowSpreadMs !== null && link.rowSpreadMs > 0 && (
        <Tooltip label="From the first to the last question of a row: so far apart are its columns">
          <span className={classes.figure}>
            spread <b>{fixed(link.rowSpreadMs, 1)}</b> ms
          </span>
        </Tooltip>
      )}
      <Tooltip label="From the sample to its way out to this page">
        <span className={classes.figure}>
          latency <b>{fixed(link.latencyMs, 1)}</b> ms
        </span>
      </Tooltip>
    </section>
  );
}
