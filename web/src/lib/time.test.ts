import { afterEach, describe, expect, it } from "vitest";
import { look } from "./look";
import { agoText, dateTimeOf, dayText, fullTimeOf, timeOf } from "./time";

const SOURCES = import.meta.glob("/src/**/*.{ts,tsx}", { query: "?raw", import: "default", eager: true });

afterEach(() => look.set({ ...look.get(), clock: "local" }));

describe("times and dates", () => {
  it("are of 24 hours, from the year to the second", () => {
    expect(timeOf(new Date(2026, 0, 1, 0, 5))).toBe("00:05:00");
    expect(dateTimeOf(new Date(2026, 2, 7, 14, 5, 9))).toBe("2026-03-07 14:05:09");
    expect(dateTimeOf(new Date(2019, 6, 2, 3, 4, 5))).toBe("2019-07-02 03:04:05");
  });

  it("are in UTC where the page is set to it", () => {
    const at = Date.UTC(2026, 2, 7, 23, 5, 9);
    look.set({ ...look.get(), clock: "utc" });
    expect(dateTimeOf(at)).toBe("2026-03-07 23:05:09Z");
    expect(timeOf(at)).toBe("23:05:09Z");
    expect(dayText(new Date(at).toISOString(), new Date(at + 3 * 3600_000))).toBe("Yesterday");
    expect(fullTimeOf(at)).toContain(" · 2026-03-07 23:05:09Z");
  });

  it("are told from now within a day", () => {
    const now = new Date(2026, 2, 7, 14).getTime();
    expect(agoText(now - 5_000, now)).toBe("just now");
    expect(agoText(now - 59.9 * 60_000, now)).toBe("59 min ago");
    expect(agoText(now - 23.9 * 3600_000, now)).toBe("23 h ago");
    expect(agoText(now - 24 * 3600_000, now)).toBe("2026-03-06 14:00:00");
    expect(agoText(now + 3600_000, now)).toBe("2026-03-07 15:00:00");
  });

  it("and numbers are written in one place each", () => {
    const stray = /toLocale(Date|Time)?String|\bIntl\.|\.to(UTC|Date|Time)String\(|\.to(Fixed|Precision|Exponential)\(/;
    const others = Object.entries(SOURCES).filter(
      ([path, text]) => !path.endsWith("/lib/format.ts") && !path.includes(".test.") && stray.test(text as string),
    );
    expect(others.map(([path]) => path)).toEqual([]);
    expect(Object.keys(SOURCES).length).toBeGreaterThan(300);
  });
});
