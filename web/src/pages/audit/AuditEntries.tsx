import { Button, Text } from "@mantine/core";
import { useIntersection } from "@mantine/hooks";
import { Fragment, useCallback, useEffect, useMemo, useState } from "react";
import { useDevices } from "../../api/queries";
import { fixed } from "../../lib/format";
import { dayText } from "../../lib/time";
import { useSelection } from "../../live/selection";
import { AuditRow } from "./AuditRow";
import classes from "./audit.module.css";
import type { Entry } from "./filters";
import { type Audit, SHOWN_MAX } from "./useAudit";

const COLUMNS = ["Time", "Who", "Device", "Action", "What", "Old → new", "Outcome"] as const;

interface Props {
  audit: Audit;
  /** what is shown answers an earlier question */
  asking: boolean;
  /** somebody reads further down: new entries wait above */
  reading: boolean;
  toTop: () => void;
}

/** Entries of the log with its news, the newest first. */
export function AuditEntries({ audit, asking, reading, toTop }: Props) {
  const devices = useDevices();
  const { select } = useSelection();
  // biome-ignore lint/correctness/useExhaustiveDependencies: another function each time, and always the same
  const onSelect = useCallback(select, []);
  const byId = useMemo(() => new Map(devices.data?.map((device) => [device.id, device])), [devices.data]);
  const [seen, setSeen] = useState<number | null>(null);
  const { ref, entry: end } = useIntersection({ rootMargin: "600px" });
  const known = audit.entries ?? [];
  const newest = audit.news[0]?.id ?? known[0]?.id ?? 0;
  useEffect(() => {
    if (!reading) setSeen(newest);
  }, [reading, newest]);
  useEffect(() => {
    if (end?.isIntersecting && audit.more) audit.older();
  });

  const shown = [...audit.news.filter(({ id }) => !reading || seen === null || id <= seen), ...known];
  const waiting = audit.news.length + known.length - shown.length;
  return (
    <div className={classes.log}>
      {waiting > 0 && (
        <Button
          size="compact-xs"
          className={classes.newer ?? ""}
          onClick={() => {
            setSeen(newest);
            toTop();
          }}
        >
          {waiting} new
        </Button>
      )}
      <table
        className={`${classes.table} fades text-12 tight w-full anywhere`}
        data-testid="audit"
        data-stale={audit.stale || asking}
        aria-busy={asking}
      >
        <thead>
          <tr>
            {COLUMNS.map((name) => (
              <th key={name} scope="col">
                {name}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {shown.map((entry, index) => (
            <Fragment key={entry.id}>
              <Day entry={entry} above={shown[index - 1]} />
              <AuditRow
                entry={entry}
                device={entry.device === null ? undefined : byId.get(entry.device)}
                onSelect={onSelect}
              />
            </Fragment>
          ))}
        </tbody>
      </table>
      <div ref={ref} className="center pt-8 dim">
        {audit.more ? (
          <Button variant="default" loading={audit.loadingMore} onClick={audit.older}>
            Older
          </Button>
        ) : known.length >= SHOWN_MAX ? (
          <Text size="xs">The newest {fixed(known.length)} of them: narrow the search to see older ones.</Text>
        ) : (
          <Text size="xs">No older ones.</Text>
        )}
      </div>
    </div>
  );
}

/** A line of its own where another day begins. */
function Day({ entry, above }: { entry: Entry; above: Entry | undefined }) {
  const today = new Date();
  const day = dayText(entry.time, today);
  if (above !== undefined && dayText(above.time, today) === day) return null;
  return (
    <tr className={classes.day}>
      <th scope="rowgroup" colSpan={COLUMNS.length}>
        {day}
      </th>
    </tr>
  );
}
