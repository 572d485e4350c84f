import { Text } from "@mantine/core";
import { fixed } from "../../lib/format";
import { type EventEntry, isFault } from "./EventLog";
import classes from "./events.module.css";
import type { EventBit } from "./useEvents";

const SHOWN = 100;

function clock(unixS: number): string {
  const when = new Date(unixS * 1000);
  const two = (value: number) => String(value).padStart(2, "0");
  return `${two(when.getHours())}:${two(when.getMinutes())}:${two(when.getSeconds())}`;
}

interface Props {
  entries: readonly EventEntry[];
  bits: readonly EventBit[];
  /** Unix time of device time 0, for entries of which only the socket has told [s] */
  originS: number | null;
}

/** The newest events as text, newest first. */
export function EventList({ entries, bits, originS }: Props) {
  return (
    <>
      <ul
        className={`${classes.list} tall list scroll`}
        aria-label="Events, newest first"
        // biome-ignore lint/a11y/noNoninteractiveTabindex: a list that scrolls has to be reached with the keys
        tabIndex={0}
        data-testid="event-list"
      >
        {entries
          .slice(-SHOWN)
          .reverse()
          .map((entry) => {
            const unixS = entry.unixS ?? (originS === null ? null : originS + entry.timeS);
            return (
              <li
                key={entry.seq}
                className={`${classes.entry} grid rule-top text-12 tight`}
                data-fault={entry.names.some(isFault)}
              >
                <span className="num nowrap">
                  {fixed(entry.timeS, 3)} s{" "}
                  <Text span size="xs" c="dimmed">
                    {unixS !== null && clock(unixS)}
                  </Text>
                </span>
                <span className="lines-12">
                  {entry.names.map((name) => (
                    <span key={name}>
                      <b className={isFault(name) ? "fault" : ""}>{name}</b>{" "}
                      <span className="dim">{bits.find((bit) => bit.name === name)?.help}</span>
                    </span>
                  ))}
                </span>
              </li>
            );
          })}
      </ul>
      {entries.length > SHOWN && (
        <Text size="xs" c="dimmed">
          The newest {SHOWN} of {fixed(entries.length)}.
        </Text>
      )}
    </>
  );
}
