import type { Schemas } from "../../api/client";
import type { Device } from "../../api/queries";
import { compact, duration } from "../../lib/format";
import type { Net } from "./wires";

export type TogetherMove = Schemas["TogetherMove"];
export type StartedTogether = Schemas["StartedTogether"];
export type AxisStart = Schemas["AxisStart"];
export type StraightLine = Pick<Schemas["StraightLine"], "axes" | "points" | "pace" | "duration_s">;
export type LinePlan = Schemas["LinePlan"];
export type AxisPath = Schemas["AxisPath"];
export type LinePath = Schemas["LinePath"];
export type LineState = Schemas["LineState"];

/** One axis that may take part, and what stands in its row. */
export interface Row {
  key: string;
  device: string;
  axis: number;
  /** of device and axis */
  title: string;
}

/** What a user has said of an axis. */
export interface Choice {
  chosen: boolean;
  target: number | null;
}

export type Choices = Readonly<Record<string, Choice>>;

export const UNSAID: Choice = { chosen: false, target: null };

/** Every axis of every device that is connected and can be sent somewhere, in their order. */
export function rowsOf(devices: readonly Pick<Device, "id" | "name" | "state" | "axes" | "about">[]): Row[] {
  return devices
    .filter(({ state, about }) => state === "connected" && can(about))
    .flatMap((device) =>
      device.axes.map(({ index, name }) => ({
        key: `${device.id}/${index}`,
        device: device.id,
        axis: index,
        title: titleOf(device.name, index, name, device.axes.length > 1),
      })),
    );
}

/** Names device and axis: the device alone where the axis has its name, or none and no other beside it. */
function titleOf(device: string, index: number, name: string, several: boolean): string {
  const number = `axis ${index}`;
  const own = ["", String(index), number].includes(name) ? "" : name;
  if (own === device) return device;
  return `${device} ${own || (several ? number : "")}`.trim();
}

/** The title of an axis that may have gone since. */
export function titleIn(rows: readonly Row[], { device, axis }: Pick<Row, "device" | "axis">): string {
  return rows.find((row) => row.device === device && row.axis === axis)?.title ?? `${device} axis ${axis}`;
}

/** A driver that only takes steps goes nowhere by itself. */
function can({ capabilities }: Device["about"]): boolean {
  return capabilities.includes("motion") && !capabilities.includes("step_input");
}

/** The moves of the chosen axes; null while one of them has no target, or none is chosen. */
export function movesOf(rows: readonly Row[], choices: Choices, relative: boolean): TogetherMove[] | null {
  const chosen = rows.filter(({ key }) => choices[key]?.chosen);
  const moves = chosen.flatMap(({ key, device, axis }) => {
    const target = choices[key]?.target ?? null;
    return target === null ? [] : [{ device, axis, target, relative, unit: "microsteps" as const }];
  });
  return moves.length === 0 || moves.length < chosen.length ? null : moves;
}

/** How a line is gone, besides where it ends. */
export interface LineWish {
  pacePercent: number;
  /** that each leg takes at least; null: as fast as the pace says [s] */
  legS: number | null;
  /** points on the way, a position for each axis [microsteps], of the axes of that key */
  via: { axes: string; points: readonly (readonly number[])[] };
}

export const NO_WISH: LineWish = { pacePercent: 100, legS: null, via: { axes: "", points: [] } };

/** The straight line of the same choice, by way of its points; null where there is none. */
export function lineOf(moves: readonly TogetherMove[] | null, relative: boolean, wish: LineWish): StraightLine | null {
  if (moves === null || relative) return null;
  const axes = moves.map(({ device, axis }) => ({ device, axis }));
  const points = [...viaOf(axes, wish).map((point) => [...point]), moves.map(({ target }) => target)];
  return { axes, points, pace: wish.pacePercent / 100, duration_s: wish.legS };
}

/** Points on the way of a line of those axes: those of other axes are no points of it. */
export function viaOf(axes: StraightLine["axes"], { via }: LineWish): readonly (readonly number[])[] {
  return via.axes === keyOf(axes) ? via.points : [];
}

/** The wish with the end of a line as a point on the way, too. */
export function withVia(line: StraightLine, wish: LineWish): LineWish {
  return { ...wish, via: { axes: keyOf(line.axes), points: line.points } };
}

/** The wish without one of its points. */
export function withoutVia(wish: LineWish, number: number): LineWish {
  return { ...wish, via: { ...wish.via, points: wish.via.points.filter((_, index) => index !== number) } };
}

function keyOf(axes: StraightLine["axes"]): string {
  return axes.map(({ device, axis }) => `${device}/${axis}`).join(" ");
}

/** All legs of a plan as one: times from the start of the first [s], and of each axis the positions at these. */
export function pathOf({ legs }: LinePlan): { timeS: number[]; positions: number[][] } {
  let begun = 0;
  const timeS: number[] = [];
  for (const leg of legs) {
    for (const time of leg.time_s) timeS.push(begun + time);
    begun += leg.duration_s;
  }
  const positions = (legs[0]?.axes ?? []).map((_, index) => legs.flatMap((leg) => leg.axes[index]?.position ?? []));
  return { timeS, positions };
}

/**
 * A plan and what was seen of it, on the times of both: of each axis of the plan the expected positions and those
 * measured, each at its own time, NaN where there is none. Each leg begins where it is planned to.
 */
export function beside(plan: LinePlan, path: LinePath | undefined) {
  const expected = pathOf(plan);
  const axes = plan.legs[0]?.axes ?? [];
  const begins = plan.legs.map((_, leg) =>
    plan.legs.slice(0, leg).reduce((sum, { duration_s }) => sum + duration_s, 0),
  );
  const seen = axes.map(({ device, axis }) =>
    (path?.legs ?? []).slice(0, plan.legs.length).flatMap((leg, number) => {
      const own = leg.axes.find((one) => one.device === device && one.axis === axis);
      return (own?.time_s ?? []).map(
        (time, row) => [(begins[number] ?? 0) + time, own?.position[row] ?? null] as const,
      );
    }),
  );
  const timeS = [...new Set([...expected.timeS, ...seen.flatMap((samples) => samples.map(([time]) => time))])];
  timeS.sort((a, b) => a - b);
  return {
    timeS,
    expected: expected.positions.map((positions) => interpolated(timeS, expected.timeS, positions)),
    measured: seen.map((samples) => {
      const at = new Map(samples);
      return timeS.map((time) => at.get(time) ?? Number.NaN);
    }),
  };
}

/** Values at other times, on straight lines between those that are known; the last one beyond their end. */
function interpolated(times: readonly number[], known: readonly number[], values: readonly number[]): number[] {
  let row = 0;
  return times.map((time) => {
    while (row < known.length - 1 && (known[row + 1] as number) < time) row++;
    const [from, to] = [known[row] as number, known[row + 1] ?? Number.POSITIVE_INFINITY];
    const [before, after] = [values[row] as number, values[row + 1] ?? (values[row] as number)];
    return to > from && Number.isFinite(to) ? before + ((after - before) * (time - from)) / (to - from) : before;
  });
}

/** How far off the line an axis was seen; nothing where nobody knows. */
export function seenText(path: Pick<AxisPath, "off_line" | "uncertainty"> | undefined): string {
  if (path === undefined || path.off_line === null) return "";
  const unsure = path.uncertainty ? ` ± ${compact(path.uncertainty, 2)}` : "";
  return `${compact(path.off_line, 2)}${unsure} µsteps`;
}

/** How the latest line is, in words. */
export function lineText(state: LineState | undefined): string {
  if (state === undefined || state.state === "idle") return "";
  const said = state.message === "" ? "" : `: ${state.message}`;
  const seen = seenText({ off_line: state.off_line, uncertainty: state.off_line_uncertainty });
  const off = seen && `; off the line by ${seen} at the most`;
  if (state.state !== "done") return `${state.state}${said}${off}`;
  const after = state.arrivals.map(({ after_s }) => after_s);
  if (after.length === 0) return "done: all were there already";
  return `done: there after ${duration(Math.max(...after))}, seen within ${duration(Math.max(...after) - Math.min(...after))}${off}`;
}

/** A time with how much more or less it may be. */
export function skewText({ skew_s, uncertainty_s }: Pick<AxisStart, "skew_s" | "uncertainty_s">): string {
  const skew = skew_s === 0 ? "0 s" : duration(skew_s);
  return uncertainty_s === 0 ? skew : `${skew} ± ${duration(uncertainty_s)}`;
}

/** How a net is, in words. */
export function netText({ open, equal_clocks, seen_within_s }: Net): string {
  if (open !== null) return `open: ${open}`;
  return equal_clocks ? "an edge is seen at the same clock" : `an edge is seen within ${duration(seen_within_s)}`;
}
