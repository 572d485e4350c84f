import {
  IconActivity,
  IconBinaryTree,
  IconChartLine,
  IconPlugConnected,
  IconTableColumn,
  IconWaveSine,
} from "@tabler/icons-react";

/** The pages, in the order of the navigation. `short` is for the bar of a phone. */
export const PAGES = [
  { path: "/", label: "Bench", short: "Bench", Icon: IconActivity },
  { path: "/registers", label: "Registers", short: "Registers", Icon: IconTableColumn },
  { path: "/ramps", label: "Ramps", short: "Ramps", Icon: IconChartLine },
  { path: "/microsteps", label: "Microsteps", short: "µsteps", Icon: IconWaveSine },
  { path: "/chain", label: "Driver chain", short: "Chain", Icon: IconBinaryTree },
  { path: "/connections", label: "Connections", short: "Links", Icon: IconPlugConnected },
] as const;
