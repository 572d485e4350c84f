import type { ScopeRow } from "./model";
import type { RowId } from "./rows";

/** What the reader wants of a plot, whatever room there is: folded or not. */
export type Folds = Partial<Record<RowId, boolean>>;

/** Which plots give way first where the scope is too low for all. */
const FIRST_TO_FOLD: readonly RowId[] = [
  "coils",
  "current",
  "angle",
  "acceleration",
  "residual",
  "load",
  "switches",
  "deviation",
  "velocity",
  "position",
];

/** Below this a plot has no two labels on its axis. */
const PLOT_PX = 72;
const TITLE_PX = 24;
const CHANNEL_PX = 20;
const DELTA_PX = 17;
/** the time axis below the plots, with its name */
export const TIME_AXIS_PX = 48;
/** a line of folded plots, and how many stand in it */
const TRAY_PX = 30;
const TRAY_PLOTS = 4;
const GAP_PX = 2;

/** The least height of a plot with the whole of its legend beside it [px]. */
export function leastHeight({ traces }: ScopeRow, cursors: boolean): number {
  const deltas = cursors ? traces.filter((trace) => trace.shown && trace.measured).length : 0;
  return Math.max(PLOT_PX, TITLE_PX + traces.length * CHANNEL_PX + deltas * DELTA_PX);
}

/** The plots that are folded into a line below the others, so that those fit into `heightPx` whole. */
export function foldedRows(
  rows: readonly ScopeRow[],
  heightPx: number,
  wanted: Folds,
  cursors: boolean,
): ReadonlySet<RowId> {
  const folded = new Set(rows.flatMap(({ row }) => (wanted[row.id] === true ? [row.id] : [])));
  const needed = () => {
    const open = rows.filter(({ row }) => !folded.has(row.id));
    const plots = open.reduce((sum, row) => sum + leastHeight(row, cursors) + GAP_PX, TIME_AXIS_PX);
    return plots + Math.ceil(folded.size / TRAY_PLOTS) * TRAY_PX;
  };
  for (const id of FIRST_TO_FOLD) {
    if (needed() <= heightPx || rows.length - folded.size <= 1) break;
    if (wanted[id] === undefined && rows.some(({ row }) => row.id === id)) folded.add(id);
  }
  return folded;
}
