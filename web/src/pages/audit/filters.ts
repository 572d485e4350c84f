import type { Schemas } from "../../api/client";

export type Entry = Schemas["AuditEntry"];
export type Outcome = "done" | "not proven" | "refused";
export const SPANS = ["any", "15 min", "hour", "day", "week", "between"] as const;
export type Span = (typeof SPANS)[number];

/** What of the log is wanted; empty texts: everything. */
export interface Filters {
  text: string;
  device: string;
  who: string;
  action: string;
  outcome: string;
  span: Span;
  /** of span "between", as the browser's fields for time give them: local time; empty: no limit */
  from: string;
  to: string;
}

export const EVERYTHING: Filters = {
  text: "",
  device: "",
  who: "",
  action: "",
  outcome: "",
  span: "any",
  from: "",
  to: "",
};

const MINUTES: Partial<Record<Span, number>> = { "15 min": 15, hour: 60, day: 24 * 60, week: 7 * 24 * 60 };

export type Query = Record<string, string>;

/** As the server wants it. Spans end now, so they begin at a whole minute: the same question for a minute. */
export function queryOf(filters: Filters, now: Date): Query {
  const query: Query = {};
  const put = (name: string, value: string) => {
    if (value.trim() !== "") query[name] = value.trim();
  };
  put("q", filters.text);
  put("device", filters.device);
  put("who", filters.who);
  put("action", filters.action);
  put("outcome", filters.outcome);
  const minutes = MINUTES[filters.span];
  if (minutes !== undefined) {
    const whole = Math.floor(now.getTime() / 60_000) - minutes;
    query.since = new Date(whole * 60_000).toISOString();
  } else if (filters.span === "between") {
    put("since", moment(filters.from));
    put("until", moment(filters.to));
  }
  return query;
}

function moment(local: string): string {
  const at = new Date(local); // without a zone: the browser's own
  return Number.isNaN(at.getTime()) ? "" : at.toISOString();
}

export function isFiltered(filters: Filters): boolean {
  return Object.keys(queryOf(filters, new Date(0))).length > 0;
}

export function csvHref(query: Query): string {
  return `/api/v1/audit?${new URLSearchParams({ ...query, format: "csv" })}`;
}
