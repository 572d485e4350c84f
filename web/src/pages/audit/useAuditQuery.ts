import { useDebouncedValue } from "@mantine/hooks";
import { useEffect, useMemo, useState } from "react";
import { type Filters, type Query, queryOf } from "./filters";

const SETTLED_MS = 200;
const LOOK_MS = 5000;

/** What is asked for the filters once they have stood still, and whether they are ahead of it. */
export function useAuditQuery(filters: Filters): { query: Query; behind: boolean } {
  const minute = useMinute();
  // a span ends now: the question is another one each minute, and only then
  const wanted = JSON.stringify(queryOf(filters, new Date(minute * 60_000)));
  const [asked] = useDebouncedValue(wanted, SETTLED_MS);
  const query = useMemo<Query>(() => JSON.parse(asked), [asked]);
  return { query, behind: asked !== wanted };
}

const now = () => Math.floor(Date.now() / 60_000);

function useMinute(): number {
  const [minute, setMinute] = useState(now);
  useEffect(() => {
    const timer = setInterval(() => setMinute(now()), LOOK_MS);
    return () => clearInterval(timer);
  }, []);
  return minute;
}
