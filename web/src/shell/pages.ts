import {
  IconActivity,
  IconArrowsSplit2,
  IconCode,
  IconCube,
  IconFileStack,
  IconGauge,
  IconHeartRateMonitor,
  IconHistory,
  IconPlayerRecord,
  IconPlugConnected,
  IconRotate360,
  IconRotateClockwise2,
  IconRoute,
  IconTableColumn,
  IconTargetArrow,
  IconTerminal2,
  IconWaveSine,
} from "@tabler/icons-react";
import type { Capability } from "../api/queries";
import { FAMILIES } from "../families/families";
import { type PageEntry, page } from "../families/family";

/** The pages that are for devices of one family alone. */
export const FAMILY_PAGES = Object.values(FAMILIES).flatMap(({ pages }) => pages);

/** The pages, in the order of the navigation. */
export const PAGES: readonly PageEntry[] = [
  page(0, "/", "Bench", "Bench", IconActivity, { alone: true }),
  page(10, "/registers", "Registers", "Regs", IconTableColumn, { needs: ["registers"], topic: "settings" }),
  page(50, "/microsteps", "Microsteps", "µsteps", IconWaveSine, {
    needs: ["microsteps.ram", "microsteps.mslut", "step_dir"],
    alone: true,
  }),
  page(80, "/encoder", "Encoder", "Encoder", IconRotateClockwise2, {
    needs: ["encoder"],
    unless: "closed_loop",
    topic: "encoder",
  }),
  page(81, "/stallguard", "StallGuard", "Stall", IconGauge, { needs: ["stallguard"] }),
  page(82, "/rotary", "Rotary", "Rotary", IconRotate360, { needs: ["motion"], unless: "step_input" }),
  page(85, "/tune", "Tune", "Tune", IconTargetArrow, { needs: ["motion"] }),
  page(83, "/twin", "3D", "3D", IconCube, { needs: ["motion"] }),
  page(84, "/program", "Program", "Program", IconCode, { needs: ["programs"] }),
  page(86, "/together", "Together", "Sync", IconArrowsSplit2, { needs: ["motion"], alone: true }),
  page(90, "/recordings", "Recordings", "Records", IconPlayerRecord, { alone: true }),
  page(91, "/profiles", "Profiles", "Profiles", IconFileStack, { alone: true }),
  page(92, "/console", "Console", "Console", IconTerminal2),
  page(93, "/audit", "Audit log", "Audit", IconHistory, { alone: true }),
  page(94, "/health", "Health", "Health", IconHeartRateMonitor, { alone: true }),
  page(94.5, "/first-run", "First run", "Set up", IconRoute, { needs: ["motion"] }),
  page(95, "/connections", "Connections", "Links", IconPlugConnected, { alone: true }),
  ...FAMILY_PAGES,
].sort((one, other) => one.place - other.place);

export type Abilities = readonly Capability[];

/** Whether a page is for devices that can this. */
export function isFor({ needs, unless }: PageEntry, abilities: Abilities): boolean {
  if (unless && abilities.includes(unless)) return false;
  return needs.length === 0 || needs.some((need) => abilities.includes(need));
}

/** The pages that make sense for a device that can this; without a device (null), those that say something alone. */
export function pagesFor(abilities: Abilities | null): PageEntry[] {
  return PAGES.filter((entry) => (abilities === null ? entry.alone : isFor(entry, abilities)));
}

/** Whether the user is on the page of that path: on it, or on one below it. */
export function isAt(path: string, location: string): boolean {
  return location === path || (path !== "/" && location.startsWith(`${path}/`));
}

/** The page of a topic for a device that can this: its registers or its parameters are "settings". */
export function pageAbout(topic: PageEntry["topic"], abilities: Abilities): PageEntry | undefined {
  return pagesFor(abilities).find((candidate) => topic !== "" && candidate.topic === topic);
}

/** Where the user goes whose device a page is not for: to one of the same topic, else to the device's settings. */
export function insteadOf(entry: PageEntry, abilities: Abilities): PageEntry | undefined {
  return pageAbout(entry.topic, abilities) ?? pageAbout("settings", abilities);
}
