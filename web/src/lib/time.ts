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
