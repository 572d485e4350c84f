import type { Schemas } from "../../api/client";
import { fixed } from "../../lib/format";
import { type FigureRow, FiguresTable } from "./FiguresTable";

type Figures = Schemas["MicrostepMetrics"];

const percent = (share: number | null) => (share === null ? "–" : fixed(share * 100, 2, "%"));
const degrees = (angle: number | null) => (angle === null ? "–" : `${fixed(angle, 2)}°`);
const ratio = (value: number | null) => (value === null ? "–" : `${fixed(value, 2)} ×`);

const ROWS: readonly FigureRow<Figures>[] = [
  {
    name: "angle error, worst",
    title: "electrical degrees from the ideal angle",
    of: (m) => degrees(m.angle_error_max_deg),
    worth: (m) => m.angle_error_max_deg,
  },
  {
    name: "angle error, rms",
    title: "over the full period",
    of: (m) => degrees(m.angle_error_rms_deg),
    worth: (m) => m.angle_error_rms_deg,
  },
  {
    name: "vector length ripple",
    title: "(longest − shortest) / mean: the torque ripple of an ideal motor",
    of: (m) => percent(m.vector_length_ripple),
    worth: (m) => m.vector_length_ripple,
  },
  { name: "vector length, mean", title: "in DAC counts", of: (m) => fixed(m.vector_length_mean, 2), worth: null },
  {
    name: "harmonics in all (THD)",
    title: "all harmonics above the first, relative to it",
    of: (m) => percent(m.thd),
    worth: (m) => m.thd,
  },
  {
    name: "longest step",
    title: "of an ideal microstep",
    of: (m) => (m.worst_step === null ? "–" : `${ratio(m.worst_step_ratio)} at step ${m.worst_step}`),
    worth: (m) => m.worst_step_ratio,
  },
  {
    name: "shortest step",
    title: "of an ideal microstep; 0 is standstill, below 0 backwards",
    of: (m) => ratio(m.smallest_step_ratio),
    worth: (m) => (m.smallest_step_ratio === null ? null : -m.smallest_step_ratio),
  },
];

/** The figures of the design beside those of the chip's present table. */
export function Metrics({ before, after }: { before: Figures | null; after: Figures }) {
  return (
    <FiguresTable rows={ROWS} before={before} beforeName="chip" after={after} words={["better", "worse"]} judged />
  );
}
