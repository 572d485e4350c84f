import {
  IconActivity,
  IconAdjustments,
  IconBinaryTree,
  IconChartLine,
  IconGauge,
  IconPlugConnected,
  IconRotateClockwise2,
  IconTableColumn,
  IconTerminal2,
  IconWaveSine,
} from "@tabler/icons-react";
import type { Family } from "../lib/family";

export interface PageEntry {
  path: string;
  label: string;
  /** for the bar of a phone */
  short: string;
  Icon: typeof IconActivity;
  /** of which devices the page tells; null: of every one */
  family: Family | null;
  /** it says something without a device, too */
  alone: boolean;
  /** what does that for the other family */
  instead: string;
}

/** The pages, in the order of the navigation. */
export const PAGES: readonly PageEntry[] = [
  page("/", "Bench", "Bench", IconActivity, { alone: true }),
  page("/registers", "Registers", "Registers", IconTableColumn, { family: "chip", instead: "/parameters" }),
  page("/ramps", "Ramps", "Ramps", IconChartLine, { family: "chip", alone: true, instead: "/parameters" }),
  page("/microsteps", "Microsteps", "µsteps", IconWaveSine, { family: "chip", alone: true, instead: "/parameters" }),
  page("/chain", "Driver chain", "Chain", IconBinaryTree, { family: "chip", alone: true, instead: "/parameters" }),
  page("/parameters", "Parameters", "Params", IconAdjustments, { family: "module", instead: "/registers" }),
  page("/encoder", "Encoder", "Encoder", IconRotateClockwise2, { family: "module" }),
  page("/stallguard", "StallGuard", "Stall", IconGauge, { family: "module" }),
  page("/console", "Console", "Console", IconTerminal2, {}),
  page("/connections", "Connections", "Links", IconPlugConnected, { alone: true }),
];

function page(
  path: string,
  label: string,
  short: string,
  Icon: typeof IconActivity,
  more: Partial<Pick<PageEntry, "family" | "alone" | "instead">>,
): PageEntry {
  return { path, label, short, Icon, family: null, alone: false, instead: "/", ...more };
}

/** The pages that make sense for a device of that family; without a device (null), those that say something alone. */
export function pagesFor(family: Family | null): PageEntry[] {
  return PAGES.filter((entry) => (family === null ? entry.alone : entry.family === null || entry.family === family));
}

export function pageAt(path: string): PageEntry | undefined {
  return PAGES.find((entry) => entry.path === path);
}
