import type { Schemas } from "../../../api/client";
import { fixed } from "../../../lib/format";
import { type FigureRow, FiguresTable } from "../FiguresTable";

export type Figures = Schemas["MslutFigures"];

const percent = (share: number | null) => (share === null ? "–" : fixed(share * 100, 2, "%"));
const degrees = (angle: number | null, microsteps: number | null) =>
  angle === null ? "–" : `${fixed(angle, 3)}°, ${fixed(microsteps, 2)} µstep`;
const order = (which: number) => (figures: Figures) => figures.angle_orders?.find((part) => part.order === which);
const size = (which: number) => (figures: Figures) => {
  const part = order(which)(figures);
  return part === undefined ? null : Math.abs(part.amplitude_deg);
};

const ROWS: readonly FigureRow<Figures>[] = [
  {
    name: "angle error, worst",
    title: "electrical degrees, and microsteps of 1/1024 period, from the ideal angle",
    of: (m) => degrees(m.angle_error_max_deg, m.angle_error_max_microsteps),
    worth: (m) => m.angle_error_max_deg,
  },
  {
    name: "angle error, rms",
    title: "over the full period",
    of: (m) => degrees(m.angle_error_rms_deg, m.angle_error_rms_microsteps),
    worth: (m) => m.angle_error_rms_deg,
  },
  {
    name: "of which 4θ",
    title: "the part that repeats four times a period: what a linearity correction changes on purpose",
    of: (m) => degrees(order(4)(m)?.amplitude_deg ?? null, order(4)(m)?.amplitude_microsteps ?? null),
    worth: size(4),
  },
  {
    name: "of which 8θ",
    title: "the part that repeats eight times a period",
    of: (m) => degrees(order(8)(m)?.amplitude_deg ?? null, order(8)(m)?.amplitude_microsteps ?? null),
    worth: size(8),
  },
  {
    name: "torque ripple",
    title: "(longest − shortest) / mean vector length: of a motor whose flux is a pure sine",
    of: (m) => percent(m.torque_ripple),
    worth: (m) => m.torque_ripple,
  },
  {
    name: "amplitude",
    title: "vector length, shortest to longest, in counts",
    of: (m) => `${fixed(m.amplitude_min, 1)}…${fixed(m.amplitude_max, 1)}`,
    worth: null,
  },
  {
    name: "quantisation, rms",
    title: "of the table's values against the formula's, in counts; a drawn wave has no formula",
    of: (m) => fixed(m.quantisation_rms, 2),
    worth: null,
  },
  {
    name: "harmonics in all (THD)",
    title: "of the phase current, all above the first, relative to it",
    of: (m) => percent(m.thd),
    worth: (m) => m.thd,
  },
  {
    name: "longest step",
    title: "of an ideal microstep",
    of: (m) => (m.largest_step_ratio === null ? "–" : `${fixed(m.largest_step_ratio, 2)} ×`),
    worth: (m) => m.largest_step_ratio,
  },
  {
    name: "shortest step",
    title: "of an ideal microstep; 0 is standstill, below 0 backwards",
    of: (m) => (m.smallest_step_ratio === null ? "–" : `${fixed(m.smallest_step_ratio, 2)} ×`),
    worth: (m) => m.smallest_step_ratio,
  },
];

interface Props {
  before: Figures | null;
  beforeName: string;
  after: Figures;
}

/** The figures of the design beside those of the wave in the chip, or of the power-on wave. */
export function FigureTable(props: Props) {
  return <FiguresTable rows={ROWS} words={["smaller", "larger"]} judged={false} {...props} />;
}
