import { useMemo } from "react";
import type { Schemas } from "../../api/client";
import { colorOf, lineOf } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { Plot } from "../../plots/Plot";

interface Props {
  rows: readonly Schemas["SequencerRow"][];
  before: readonly Schemas["SequencerRow"][] | null;
}

const LANES = ["FD_B", "FD_A", "PH_B", "PH_A"] as const;
const GROUP = "microsteps";

/** Both phase currents over a full electrical period, and the bits that go with them (Tables 12-3, 12-4). */
export function Waves({ rows, before }: Props) {
  const scheme = useScheme();
  // One more step closes the period, so that the last one is as wide as the others.
  const index = useMemo(() => [...rows.map((_, step) => step), rows.length], [rows]);
  const currents = useMemo(() => {
    const closed = (values: number[]) => [...values, values[0] ?? 0];
    const first = [closed(rows.map((row) => row.current_a)), closed(rows.map((row) => row.current_b))];
    const same = before && before.length === rows.length ? before : null;
    const old = same
      ? [closed(same.map((row) => row.current_a)), closed(same.map((row) => row.current_b))]
      : [index.map(() => Number.NaN), index.map(() => Number.NaN)];
    return [index, ...old, ...first] as const;
  }, [rows, before, index]);
  const bits = useMemo(() => {
    const lane = (name: "ph_a" | "ph_b" | "fd_a" | "fd_b", at: number) => {
      const values = rows.map((row) => at + 0.66 * row[name]);
      return [...values, values[0] ?? 0];
    };
    return [index, lane("fd_b", 0), lane("fd_a", 1), lane("ph_b", 2), lane("ph_a", 3)] as const;
  }, [rows, index]);
  const color = colorOf("phase_a", scheme);
  const grey = colorOf("target_position", scheme);
  const last = rows.length;
  return (
    <>
      <Plot
        label="Phase currents over a full period"
        summary={`${rows.length} microsteps; before in grey`}
        series={[
          { label: "before A", color: grey, stepped: true },
          { label: "before B", color: grey, stepped: true, dash: [4, 3] },
          { label: "Phase A (sine)", color, stepped: true, width: 1.5 },
          { label: "Phase B (cosine)", ...lineOf("phase_b", scheme), stepped: true, width: 1.5 },
        ]}
        data={currents}
        height={210}
        group={GROUP}
        limit={[0, last]}
        x={{ axis: false }}
        scales={{ y: { range: [-70, 70], at: [-63, -32, 0, 32, 63] } }}
      />
      <Plot
        label="Phase and fast-decay bits over a full period"
        series={[
          { label: "FD_B", color, stepped: true, dash: [3, 2], width: 1.5 },
          { label: "FD_A", color, stepped: true, dash: [3, 2], width: 1.5 },
          { label: "PH_B", color, stepped: true, width: 1.5 },
          { label: "PH_A", color, stepped: true, width: 1.5 },
        ]}
        data={bits}
        legend={false}
        height={112}
        group={GROUP}
        limit={[0, last]}
        x={{ label: "microstep of the period" }}
        scales={{
          y: { range: [-0.15, 3.85], at: [0.33, 1.33, 2.33, 3.33], ticks: () => [...LANES] },
        }}
      />
    </>
  );
}
