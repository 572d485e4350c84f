import { SegmentedControl, Text } from "@mantine/core";
import { useState } from "react";
import type { Device } from "../../api/queries";
import { familyOf } from "../../families/families";
import { optionsOf } from "../../lib/choices";
import { fixed } from "../../lib/format";
import { Loading } from "../../lib/Loading";
import { later } from "../../lib/later";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { usePhone } from "../../lib/usePhone";
import type { TelemetrySource } from "../../live/TelemetrySource";
import classes from "./events.module.css";
import type { TimeWindow } from "./Lanes";
import { useEventRegisters, useEvents } from "./useEvents";

const EventList = later(() => import("./EventList").then((part) => part.EventList));
const Lanes = later(() => import("./Lanes").then((part) => part.Lanes));

interface Props {
  device: Device;
  axis: number;
  name: string;
  source: TelemetrySource | undefined;
  connected: boolean;
  window: TimeWindow;
}

/** What the chip's event registers have told, on the time axis of the plots above it: a row for each bit that occurred. */
export function EventsTimeline({ device, axis, name, source, connected, window }: Props) {
  const phone = usePhone();
  const [view, setView] = useState<"timeline" | "list">("timeline");
  const events = useEvents(device, axis, source, connected);
  const registers = useEventRegisters(device);
  const { lanes, log, query } = events;
  const originS = source?.link().timeOriginUnixS ?? null;
  const asList = phone || view === "list";
  return (
    <section className={classes.events} aria-label={`Events of ${name}`} data-testid="events" data-stale={!connected}>
      <header className={`${classes.head} row gap-8`}>
        <h2 className="m-0 text-12 bold">Events</h2>
        <Text size="xs" c="dimmed" className="grow" data-testid="event-count">
          {log.entries.length === 0 ? "" : `${fixed(log.entries.length)} seen`}
          {log.lost > 0 && `, ${fixed(log.lost)} before them forgotten`}
        </Text>
        {!phone && (
          <SegmentedControl
            aria-label="Events as"
            data={optionsOf({ timeline: "Timeline", list: "List" })}
            value={view}
            onChange={(value) => setView(value as "timeline" | "list")}
          />
        )}
      </header>
      {query.isError && connected && (
        <ProblemAlert error={query.error} doing="Asking for events" retry={() => void query.refetch()} />
      )}
      {lanes.length === 0 ? (
        <Nothing
          pending={query.isPending && connected}
          connected={connected}
          registers={registers}
          need={familyOf(device)?.eventsNeed}
        />
      ) : asList ? (
        <EventList entries={log.entries} bits={events.bits} originS={originS} />
      ) : (
        <Lanes lanes={lanes} bits={events.bits} window={window} name={name} />
      )}
    </section>
  );
}

interface NothingProps {
  pending: boolean;
  connected: boolean;
  registers: readonly string[];
  need: string | undefined;
}

function Nothing({ pending, connected, registers, need }: NothingProps) {
  if (pending) return <Loading size="xs" label="Asking for events" />;
  return (
    <Text size="xs" c="dimmed" pb={6}>
      {connected
        ? `No event yet. Move the motor, or push a switch: what ${registers.join(" and ")} ${
            registers.length === 1 ? "tells" : "tell"
          }${need === undefined ? "" : ` by a bit ${need}`} gets a row here, and nothing is lost by looking.`
        : "Not connected: no events are asked for."}
    </Text>
  );
}
