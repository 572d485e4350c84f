import { Card } from "../../../lib/Card";
import { compact, counted } from "../../../lib/format";
import { FiguresTable } from "../FiguresTable";
import type { Study } from "../study";
import { Campbell } from "./Campbell";
import { ChangeCard } from "./Changes";
import { campbellOf, type ResonanceFound } from "./dots";

/** The map as a Campbell plot and as a table, and what each change made of it. */
export function Results({ study }: { study: Study }) {
  const found = study.resonances;
  return found ? <Found found={found} /> : null;
}

function Found({ found }: { found: ResonanceFound }) {
  const plot = campbellOf(found);
  if (plot === null) return null;
  const hz = found.resonance_hz;
  const summary = hz === null ? counted(found.points.length, "speed") : `resonance ${compact(hz.value, 4, "Hz")}`;
  return (
    <>
      <Card title="Ripple over speed and order" note={summary}>
        <Campbell plot={plot} summary={summary} />
        <details>
          <summary className="text-13">The same as a table</summary>
          <MapTable found={found} />
        </details>
      </Card>
      {found.changes
        .filter(({ points }) => points.length > 0)
        .map((change) => (
          <ChangeCard key={change.name} change={change} />
        ))}
    </>
  );
}

function rippleOf({ lost, blind, ripple_deg: ripple }: ResonanceFound["points"][number]): string {
  if (lost > 0) return "steps lost";
  return blind > 0 ? "samples show none" : `${compact(ripple, 3)}°`;
}

function MapTable({ found }: { found: ResonanceFound }) {
  return (
    <FiguresTable
      label="Amplitude of each order at each speed"
      minWidth={560}
      heads={["turns/s", "ripple", ...found.orders.map((order) => `order ${order}`)]}
      rows={found.points.map((point) => [
        compact(point.speed_rps, 3),
        rippleOf(point),
        ...found.orders.map((_, index) => compact(point.amplitudes_deg[index] ?? null, 2)),
      ])}
    />
  );
}
