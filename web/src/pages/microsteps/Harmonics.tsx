import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { type Bar, Bars } from "./Bars";

interface Props {
  /** which are shown: 2 is the first above the fundamental */
  numbers: readonly number[];
  /** share of the fundamental, from the first on */
  design: readonly number[] | null | undefined;
  before: readonly number[] | null | undefined;
  stale: boolean;
  height: number;
}

/** The harmonics of the phase current; the worst is named. */
export function Harmonics({ numbers, design, before, stale, height }: Props) {
  const percent = (shares: readonly number[] | null | undefined, number: number) =>
    shares ? (shares[number - 1] ?? 0) * 100 : null;
  const bars = numbers.map(
    (number): Bar => ({
      label: `harmonic ${number}`,
      value: percent(design, number) ?? 0,
      before: percent(before, number),
    }),
  );
  // the first of equals
  const worst = bars.reduce<number | null>(
    (most, bar, index) => (most === null || (bar.value ?? 0) > (bars[most]?.value ?? 0) + 1e-9 ? index : most),
    null,
  );
  return (
    <Card title="Harmonics" note="of the first, logarithmic">
      <div className={stale ? "stale" : ""}>
        <Bars
          label="Harmonics of the phase current"
          bars={bars}
          height={height}
          scale={{ low: 0.01, high: 100, ticks: [0.01, 0.1, 1, 10, 100], log: true }}
          format={(value) => (value === null ? "–" : fixed(value, decimalsOf(value), "%"))}
          marked={worst}
          every={1}
        />
      </div>
    </Card>
  );
}

function decimalsOf(percent: number): number {
  if (percent >= 10) return 0;
  if (percent >= 0.1) return 1;
  return percent >= 0.01 ? 2 : 3;
}
