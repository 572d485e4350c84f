import {
  IconActivity,
  IconAdjustments,
  IconBinaryTree,
  IconBolt,
  IconChartLine,
  IconCube,
  IconFileStack,
  IconFilter,
  IconGauge,
  IconHeartRateMonitor,
  IconHistory,
  IconPlayerRecord,
  IconPlugConnected,
  IconRotate360,
  IconRotateClockwise2,
  IconTableColumn,
  IconTargetArrow,
  IconTerminal2,
  IconTimeline,
  IconVectorSpline,
  IconWaveSine,
} from "@tabler/icons-react";
import { CHIPS, type Family } from "../lib/family";

export interface PageEntry {
  path: string;
  label: string;
  /** for the bar of a phone */
  short: string;
  Icon: typeof IconActivity;
  /** of which devices the page tells; none: of every one */
  families: readonly Family[];
  /** it says something without a device, too */
  alone: boolean;
  /** what does that for another family; the bench where nothing does */
  instead: Partial<Record<Family, string>>;
}

/** The pages, in the order of the navigation. */
export const PAGES: readonly PageEntry[] = [
  page("/", "Bench", "Bench", IconActivity, { alone: true }),
  page("/registers", "Registers", "Registers", IconTableColumn, {
    families: CHIPS,
    instead: { module: "/parameters" },
  }),
  page("/ramps", "Ramps", "Ramps", IconChartLine, {
    families: ["pmul"],
    alone: true,
    instead: { module: "/parameters", sramp: "/sramp", sixpoint: "/sixpoint" },
  }),
  page("/sramp", "S-ramp", "S-ramp", IconVectorSpline, {
    families: ["sramp"],
    alone: true,
    instead: { module: "/parameters", pmul: "/ramps", sixpoint: "/sixpoint" },
  }),
  page("/sixpoint", "SixPoint ramp", "SixPoint", IconTimeline, {
    families: ["sixpoint"],
    alone: true,
    instead: { module: "/parameters", pmul: "/ramps", sramp: "/sramp" },
  }),
  page("/closed-loop", "Closed loop", "Loop", IconTargetArrow, {
    families: ["sramp"],
    instead: { module: "/encoder", pmul: "/registers", sixpoint: "/encoder" },
  }),
  page("/filters", "Input filters", "Filters", IconFilter, {
    families: ["sramp"],
    alone: true,
    instead: { module: "/parameters", pmul: "/registers", sixpoint: "/registers" },
  }),
  page("/currents", "Currents", "Currents", IconBolt, {
    families: ["sixpoint"],
    alone: true,
    instead: { module: "/parameters", pmul: "/registers", sramp: "/registers" },
  }),
  page("/microsteps", "Microsteps", "µsteps", IconWaveSine, {
    families: CHIPS,
    alone: true,
    instead: { module: "/parameters" },
  }),
  page("/chain", "Driver chain", "Chain", IconBinaryTree, {
    families: ["pmul"],
    alone: true,
    instead: { module: "/parameters", sramp: "/registers", sixpoint: "/registers" },
  }),
  page("/parameters", "Parameters", "Params", IconAdjustments, {
    families: ["module"],
    instead: { pmul: "/registers", sramp: "/registers", sixpoint: "/registers" },
  }),
  page("/encoder", "Encoder", "Encoder", IconRotateClockwise2, {
    families: ["sixpoint", "module"],
    instead: { sramp: "/closed-loop", pmul: "/registers" },
  }),
  page("/stallguard", "StallGuard", "Stall", IconGauge, { families: ["sixpoint", "module"] }),
  page("/rotary", "Rotary", "Rotary", IconRotate360, {}),
  page("/twin", "3D", "3D", IconCube, {}),
  page("/recordings", "Recordings", "Records", IconPlayerRecord, { alone: true }),
  page("/profiles", "Profiles", "Profiles", IconFileStack, { alone: true }),
  page("/console", "Console", "Console", IconTerminal2, {}),
  page("/audit", "Audit log", "Audit", IconHistory, { alone: true }),
  page("/health", "Health", "Health", IconHeartRateMonitor, { alone: true }),
  page("/connections", "Connections", "Links", IconPlugConnected, { alone: true }),
];

function page(
  path: string,
  label: string,
  short: string,
  Icon: typeof IconActivity,
  more: Partial<Pick<PageEntry, "families" | "alone" | "instead">>,
): PageEntry {
  return { path, label, short, Icon, families: [], alone: false, instead: {}, ...more };
}

/** The pages that make sense for a device of that family; without a device (null), those that say something alone. */
export function pagesFor(family: Family | null): PageEntry[] {
  return PAGES.filter(({ families, alone }) =>
    family === null ? alone : families.length === 0 || families.includes(family),
  );
}

export function pageAt(path: string): PageEntry | undefined {
  return PAGES.find((entry) => entry.path === path);
}

/** Whether somebody is on the page of that path: on it, or on one below it. */
export function isAt(path: string, location: string): boolean {
  return location === path || (path !== "/" && location.startsWith(`${path}/`));
}

/** Where somebody with a device of that family goes from a page that is not for it. */
export function insteadOf(entry: PageEntry, family: Family): { href: string; label: string } {
  const href = entry.instead[family] ?? "/";
  return { href, label: pageAt(href)?.label ?? "Bench" };
}
