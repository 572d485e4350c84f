/**
 * One way to write times and dates on every page: 2026-03-07 14:05:09 of 24 hours, in the browser's zone or, by a setting
 * of the page, in UTC: then with a Z behind.
 */
import { type Clock, look } from "./look";

const two = (value: number) => String(value).padStart(2, "0");

/** The date as if UTC were the zone: its UTC parts are what is to be written. */
function inZone(at: Date | number, clock: Clock): Date {
  const when = new Date(at);
  return clock === "utc" ? when : new Date(when.getTime() - when.getTimezoneOffset() * 60_000);
}

function dayIn(at: Date | number, clock: Clock): string {
  const when = inZone(at, clock);
  return `${when.getUTCFullYear()}-${two(when.getUTCMonth() + 1)}-${two(when.getUTCDate())}`;
}

function timeIn(at: Date | number, clock: Clock): string {
  const when = inZone(at, clock);
  const parts = [when.getUTCHours(), when.getUTCMinutes(), when.getUTCSeconds()].map(two);
  return parts.join(":") + (clock === "utc" ? "Z" : "");
}

/** 18:45:09 */
export function timeOf(at: Date | number): string {
  return timeIn(at, look.get().clock);
}

/** 2026-03-07 14:05:09 */
export function dateTimeOf(at: Date | number): string {
  const { clock } = look.get();
  return `${dayIn(at, clock)} ${timeIn(at, clock)}`;
}

/** In full, in both zones: to be read where a shorter text is pointed at. */
export function fullTimeOf(at: Date | number): string {
  return (["local", "utc"] as const).map((clock) => `${dayIn(at, clock)} ${timeIn(at, clock)}`).join(" · ");
}

const MINUTE_MS = 60_000;
const HOUR_MS = 60 * MINUTE_MS;
const DAY_MS = 24 * HOUR_MS;

/** "12 min ago" within a day, later (and for what is still to come) the date and the time. */
export function agoText(at: number, nowMs: number): string {
  const age = nowMs - at;
  if (age < -MINUTE_MS || age >= DAY_MS) return dateTimeOf(at);
  if (age < MINUTE_MS) return "just now";
  return age < HOUR_MS ? `${Math.floor(age / MINUTE_MS)} min ago` : `${Math.floor(age / HOUR_MS)} h ago`;
}

const WEEKDAYS = ["Sunday", "Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday"] as const;

/** Today, Yesterday, or Friday 2026-11-20. */
export function dayText(iso: string, now: Date): string {
  const { clock } = look.get();
  const at = new Date(iso);
  const day = dayIn(at, clock);
  if (day === dayIn(now, clock)) return "Today";
  if (day === dayIn(now.getTime() - DAY_MS, clock)) return "Yesterday";
  return `${WEEKDAYS[inZone(at, clock).getUTCDay()]} ${day}`;
}
