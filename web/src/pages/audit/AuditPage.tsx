import { Button, Group, Loader, Text } from "@mantine/core";
import { useDebouncedValue, useIntersection } from "@mantine/hooks";
import { IconHistory } from "@tabler/icons-react";
import { Fragment, useCallback, useEffect, useMemo, useState } from "react";
import { useDevices } from "../../api/queries";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { fixed } from "../../lib/format";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { dayText } from "../../lib/time";
import { useSelection } from "../../live/selection";
import { AuditRow } from "./AuditRow";
import classes from "./audit.module.css";
import { FilterBar } from "./FilterBar";
import { type Entry, EVERYTHING, isFiltered, queryOf } from "./filters";
import { type Audit, SHOWN_MAX, useAudit } from "./useAudit";
import { useFilters } from "./useFilters";

const COLUMNS = ["Time", "Who", "Device", "Action", "What", "Old → new", "Outcome"] as const;
/** Scrolled down further than that, rows are read: new ones wait above. */
const READING_PX = 80;

/** Who did what, when, and what came of it. */
export default function AuditPage() {
  const [filters, setFilters] = useFilters();
  const [settled] = useDebouncedValue(filters, 200);
  const minute = useMinute();
  // a span ends now: the question is another one each minute, and only then
  const query = useMemo(() => queryOf(settled, new Date(minute * 60_000)), [settled, minute]);
  const audit = useAudit(query);
  return (
    <Page name="Audit log">
      <Card title="Audit log" note={<State audit={audit} />}>
        <FilterBar filters={filters} query={query} onChange={setFilters} />
        {audit.error !== null && <ProblemAlert error={audit.error} doing="Reading the audit log" retry={audit.again} />}
        {audit.entries === undefined ? (
          audit.error === null && (
            <Group justify="center" py="xl">
              <Loader aria-label="Reading the audit log" />
            </Group>
          )
        ) : audit.entries.length + audit.news.length === 0 ? (
          <Nothing filtered={isFiltered(settled)} onAll={() => setFilters(EVERYTHING)} />
        ) : (
          <Entries audit={audit} />
        )}
      </Card>
    </Page>
  );
}

function State({ audit }: { audit: Audit }) {
  if (audit.entries === undefined) return null;
  return (
    <span role="status" className={audit.stale ? "bold" : ""} data-stale={audit.stale}>
      {audit.stale ? "no news: the server does not answer" : "live"}
    </span>
  );
}

function Nothing({ filtered, onAll }: { filtered: boolean; onAll: () => void }) {
  return (
    <EmptyState title={filtered ? "No entry has all of this" : "Nothing was done yet"} icon={<IconHistory size={22} />}>
      {filtered ? (
        <Button size="sm" variant="default" onClick={onAll}>
          Show all
        </Button>
      ) : (
        <Text size="sm">Every write, move and stop is entered here as it happens, and what was refused too.</Text>
      )}
    </EmptyState>
  );
}

function Entries({ audit }: { audit: Audit }) {
  const devices = useDevices();
  const { select } = useSelection();
  // biome-ignore lint/correctness/useExhaustiveDependencies: another function each time, and always the same
  const onSelect = useCallback(select, []);
  const byId = useMemo(() => new Map(devices.data?.map((device) => [device.id, device])), [devices.data]);
  const [seen, setSeen] = useState<number | null>(null);
  const { ref, entry: end } = useIntersection({ rootMargin: "600px" });
  const known = audit.entries ?? [];
  const reading = useScrolledDown();
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
    <>
      {waiting > 0 && (
        <Button
          size="compact-xs"
          className={classes.newer ?? ""}
          onClick={() => {
            setSeen(newest);
            window.scrollTo({ top: 0 });
          }}
        >
          {waiting} new
        </Button>
      )}
      <table
        className={`${classes.table} fades text-12 tight w-full anywhere`}
        data-testid="audit"
        data-stale={audit.stale}
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
    </>
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

const now = () => Math.floor(Date.now() / 60_000);

function useMinute(): number {
  const [minute, setMinute] = useState(now);
  useEffect(() => {
    const timer = setInterval(() => setMinute(now()), 5000);
    return () => clearInterval(timer);
  }, []);
  return minute;
}

function useScrolledDown(): boolean {
  const [down, setDown] = useState(false);
  useEffect(() => {
    const look = () => setDown(window.scrollY > READING_PX);
    look();
    window.addEventListener("scroll", look, { passive: true });
    return () => window.removeEventListener("scroll", look);
  }, []);
  return down;
}
