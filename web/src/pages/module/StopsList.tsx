import { Text } from "@mantine/core";
import type { UseQueryResult } from "@tanstack/react-query";
import { fixed } from "../../lib/format";
import { Loading } from "../../lib/Loading";
import { ProblemAlert } from "../../lib/ProblemAlert";
import classes from "./module.module.css";
import { type MotionEnd, REASONS } from "./useStops";

const SHOWN = 50;

function clock(unixS: number): string {
  const when = new Date(unixS * 1000);
  const two = (value: number) => String(value).padStart(2, "0");
  return `${two(when.getHours())}:${two(when.getMinutes())}:${two(when.getSeconds())}`;
}

/** What ended the last motions: why, when and where. */
export function StopsList({ stops }: { stops: UseQueryResult<MotionEnd[]> }) {
  if (stops.error)
    return <ProblemAlert error={stops.error} doing="Asking for the stops" retry={() => stops.refetch()} />;
  if (stops.isPending) return stops.fetchStatus === "idle" ? <Nothing /> : <Loading size="xs" label="Asking" />;
  if (stops.data.length === 0) return <Nothing />;
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: a list that scrolls has to be reached with the keys
    <ul className="tall list scroll" aria-label="What stopped the motor" tabIndex={0} data-testid="stops">
      {stops.data.slice(0, SHOWN).map((stop) => {
        const words = REASONS[stop.reason];
        return (
          <li key={`${stop.time_s}/${stop.reason}`} className={`${classes.stop} grid baseline rule-top text-12 tight`}>
            <span className={`dot ${words.fault ? "dot-fault" : ""}`} aria-hidden />
            <span>
              <span className="bold">{words.text}</span>{" "}
              <Text span size="xs" c="dimmed" className="num">
                {clock(stop.unix_s)}
              </Text>
            </span>
            <span className="mono nowrap">
              {fixed(stop.position)}{" "}
              <Text span size="xs" c="dimmed">
                µsteps
              </Text>
            </span>
            {stop.detail && <span className="dim anywhere rest">{stop.detail}</span>}
          </li>
        );
      })}
    </ul>
  );
}

function Nothing() {
  return (
    <Text size="xs" c="dimmed">
      Nothing has ended a motion yet. What does, is listed here with its time and place.
    </Text>
  );
}
