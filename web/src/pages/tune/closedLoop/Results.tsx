import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { FiguresTable } from "../FiguresTable";
import type { Study } from "../study";
import { bodeOf, type Loop, nicholsOf, tensTicks } from "./curves";

/** The loop that was worked out: its Bode and Nichols plots, and a step as it was expected and measured. */
export function Results({ study }: { study: Study }) {
  return study.loop ? <Found found={study.loop} /> : null;
}

function Found({ found }: { found: Loop }) {
  const scheme = useScheme();
  const color = colorOf("position", scheme);
  const other = colorOf("target_position", scheme);
  const margins =
    `phase margin ${compact(found.phase_margin_deg, 3)}°, gain margin ${compact(found.gain_margin, 3)}, ` +
    `bandwidth ${compact(found.bandwidth_hz, 3, "Hz")}`;
  const overshoot =
    `overshoot ${compact(100 * found.expected_overshoot, 3, "%")} expected` +
    (found.overshoot ? `, ${compact(100 * found.overshoot.value, 3, "%")} measured` : "");
  const nichols = nicholsOf(found);
  return (
    <>
      <Card title="Open loop" note={margins}>
        <Plot
          label="Bode plot of the open loop"
          summary={margins}
          height={240}
          series={[
            { label: "gain", unit: "dB", color },
            { label: "phase", unit: "°", color: other, scale: "phase" },
          ]}
          x={{ label: "frequency", unit: "Hz", ticks: tensTicks }}
          scales={{ y: { label: "gain", unit: "dB" }, phase: { label: "phase", unit: "°", side: "right" } }}
          data={bodeOf(found)}
        />
        <Plot
          label="Nichols plot of the open loop"
          summary={margins}
          height={220}
          series={[{ label: "gain", unit: "dB", color }]}
          x={{ label: "phase", unit: "°" }}
          scales={{ y: { label: "gain", unit: "dB" } }}
          data={nichols.data}
          overlays={[{ x: nichols.phase, y: nichols.gain, color, dots: 3 }]}
        />
      </Card>
      {found.grade && (
        <Card title="How good" note={`${found.grade}: as its worst`}>
          <FiguresTable
            label="Marks of the loop"
            minWidth={420}
            heads={["Of the loop", "Measured", "Mark"]}
            rows={found.grades.map(({ what, figure, mark }) => [what, figure, mark])}
          />
        </Card>
      )}
      {found.step && (
        <Card title="A step" note={overshoot}>
          <Plot
            label="Encoder after a step, measured and expected"
            summary={overshoot}
            height={220}
            series={[
              { label: "measured", color: other },
              { label: "expected", color },
            ]}
            x={{ label: "time", unit: "s" }}
            scales={{ y: { label: "share of the step" } }}
            data={[found.step.time_s, found.step.measured, found.step.expected]}
          />
        </Card>
      )}
    </>
  );
}
