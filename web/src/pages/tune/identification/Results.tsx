import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import type { Study } from "../study";

/** A ring as it was measured, and as it was fitted. */
export function Results({ study }: { study: Study }) {
  const scheme = useScheme();
  const ringing = study.identified?.ringing;
  if (!ringing) return null;
  const summary = `${compact(ringing.residual_deg, 3)}° electrical are left of all rings by the fit`;
  return (
    <Card title="A ring after a hop" note={summary}>
      <Plot
        label="Rotor after a hop, measured and fitted"
        summary={summary}
        height={220}
        series={[
          { label: "measured", unit: "°", color: colorOf("position", scheme) },
          { label: "fitted", unit: "°", color: colorOf("predicted_position", scheme) },
        ]}
        x={{ label: "time", unit: "s" }}
        scales={{ y: { label: "rotor, electrical", unit: "°" } }}
        data={[ringing.time_s, ringing.measured_deg, ringing.fitted_deg]}
      />
    </Card>
  );
}
