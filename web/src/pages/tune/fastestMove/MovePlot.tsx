import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf, type Quantity } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import type { Study } from "../study";
import { type Move, movesOf } from "./moves";

const LOOKS: Record<Move["which"], { color: Quantity; width: number }> = {
  before: { color: "target_position", width: 2 },
  best: { color: "velocity", width: 3 },
  present: { color: "predicted_position", width: 1 },
};

/** While it runs the present move over the best one and the one before, as encoder or counter saw them; else the last two. */
export function MovePlot({ study }: { study: Study }) {
  const scheme = useScheme();
  const wanted: Move["which"][] = study.state === "running" ? ["before", "best", "present"] : ["before", "best"];
  const best = study.trials.find(({ number }) => number === study.best)?.figures.time_s ?? null;
  const before = study.baseline_figures?.time_s ?? null;
  const summary =
    before === null
      ? ""
      : `${compact(before, 3, "s")} before${best === null ? "" : `, ${compact(best, 3, "s")} with the best setting`}`;
  return (
    <Card title="The move" note={summary}>
      <Plot
        label="Way over the time of a move"
        summary={summary}
        height={210}
        series={wanted.map((which) => ({
          label: which,
          unit: "full steps",
          color: colorOf(LOOKS[which].color, scheme),
          width: LOOKS[which].width,
        }))}
        x={{ label: "time since the command", unit: "s" }}
        scales={{ y: { label: "way", unit: "full steps" } }}
        data={movesOf(study.moves, wanted)}
      />
    </Card>
  );
}
