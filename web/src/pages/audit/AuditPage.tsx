import { Button, Group, Text } from "@mantine/core";
import { IconHistory } from "@tabler/icons-react";
import { useEffect, useState } from "react";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { Loading } from "../../lib/Loading";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { AuditEntries } from "./AuditEntries";
import { FilterBar } from "./FilterBar";
import { EVERYTHING } from "./filters";
import { type Audit, useAudit } from "./useAudit";
import { useAuditQuery } from "./useAuditQuery";
import { useFilters } from "./useFilters";

/** Scrolled down further than that, rows are read: new ones wait above. */
const READING_PX = 80;

/** Who did what, when, and what came of it. */
export default function AuditPage() {
  const [filters, setFilters] = useFilters();
  const { query, behind } = useAuditQuery(filters);
  const audit = useAudit(query);
  const reading = useScrolledDown();
  return (
    <Page name="Audit log">
      <Card title="Audit log" note={<State audit={audit} />}>
        <FilterBar filters={filters} query={query} onChange={setFilters} />
        {audit.error !== null && <ProblemAlert error={audit.error} doing="Reading the audit log" retry={audit.again} />}
        {audit.entries === undefined ? (
          audit.error === null && (
            <Group justify="center" py="xl">
              <Loading label="Reading the audit log" />
            </Group>
          )
        ) : audit.entries.length + audit.news.length === 0 ? (
          <Nothing filtered={Object.keys(query).length > 0} onAll={() => setFilters(EVERYTHING)} />
        ) : (
          <AuditEntries
            audit={audit}
            asking={audit.asking || behind}
            reading={reading}
            toTop={() => window.scrollTo({ top: 0 })}
          />
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
