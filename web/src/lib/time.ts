/** One way to write times and dates on every page: 24 hours, the day before the month by name, the browser's zone. */

/** 18:45:09 */
export function timeOf(at: Date | number): string {
  return new Date(at).toLocaleTimeString("en-GB");
}

/** 21 Nov 18:45:09, with its year where that is not this one's. */
export function dateTimeOf(at: Date | number): string {
  const when = new Date(at);
  const year = when.getFullYear() === new Date().getFullYear() ? "" : ` ${when.getFullYear()}`;
  return `${when.toLocaleDateString("en-GB", { day: "numeric", month: "short" })}${year} ${timeOf(when)}`;
}

const DAY_MS = 24 * 3600 * 1000;

/** Today, Yesterday, or Friday 20 November. */
export function dayText(iso: string, now: Date): string {
  const at = new Date(iso);
  const midnight = (when: Date) => new Date(when.getFullYear(), when.getMonth(), when.getDate()).getTime();
  const days = Math.round((midnight(now) - midnight(at)) / DAY_MS);
  if (days === 0) return "Today";
  if (days === 1) return "Yesterday";
  const year = at.getFullYear() === now.getFullYear() ? {} : ({ year: "numeric" } as const);
  return at.toLocaleDateString("en-GB", { weekday: "long", day: "numeric", month: "long", ...year }).replace(",", "");
}
