import { describe, expect, it } from "vitest";
import { dateTimeOf, timeOf } from "./time";

const SOURCES = import.meta.glob("/src/**/*.{ts,tsx}", { query: "?raw", import: "default", eager: true });

describe("times and dates", () => {
  it("are of 24 hours, and name the month", () => {
    const evening = new Date(new Date().getFullYear(), 10, 21, 18, 45, 9);
    expect(timeOf(evening)).toBe("18:45:09");
    expect(timeOf(new Date(2026, 0, 1, 0, 5))).toBe("00:05:00");
    expect(dateTimeOf(evening)).toBe("21 Nov 18:45:09");
    expect(dateTimeOf(new Date(2019, 0, 2, 3, 4, 5))).toBe("2 Jan 2019 03:04:05");
  });

  it("are written in one place", () => {
    const others = Object.entries(SOURCES).filter(
      ([path, text]) =>
        !path.endsWith("/lib/time.ts") &&
        !path.includes(".test.") &&
        /toLocale(Date|Time)String|Intl\.DateTimeFormat|\.to(UTC|Date|Time)String\(/.test(text as string),
    );
    expect(others.map(([path]) => path)).toEqual([]);
    expect(Object.keys(SOURCES).length).toBeGreaterThan(300);
  });
});
