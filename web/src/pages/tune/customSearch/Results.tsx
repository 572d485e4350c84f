import { Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { FiguresTable } from "../FiguresTable";
import { Parallel } from "../fastestMove/Parallel";
import type { Study } from "../study";
import { FIGURES } from "./form";
import { type CustomFound, evidenceRows, frontOfBoth, objectiveRanges, overTrials } from "./found";

/** How sure the best setting is, and what was tried. */
export function Results({ study }: { study: Study }) {
  const found = study.custom;
  if (!found || found.before === null) return null;
  return (
    <>
      {found.effects.length > 0 && <Evidence found={found} better={study.improved === true} />}
      {found.tried.length > 0 && <Trials study={study} found={found} />}
    </>
  );
}

function Evidence({ found, better }: { found: CustomFound; better: boolean }) {
  const scheme = useScheme();
  const [effect] = found.effects;
  const differences = found.pairs.map(({ baseline, winner }) => (winner[0] ?? 0) - (baseline[0] ?? 0));
  return (
    <Card title="How sure" note={better ? "better" : "not shown to be better"}>
      <FiguresTable
        label="The best setting against the one before"
        minWidth={420}
        heads={["", "Before", "Best", "Difference", "95 %", "p", ""]}
        rows={evidenceRows(found)}
      />
      <Text size="sm">
        {found.pairs.length} pairs; no step lost in {found.runs} runs: a rate below{" "}
        {compact((found.loss_rate_max ?? 1) * 100, 2, "%")}, at 95 %.
      </Text>
      {effect && (
        <Plot
          label={`Difference of each pair: ${FIGURES[effect.figure].label}`}
          height={150}
          series={[
            { label: "new less old", unit: effect.unit, color: colorOf("residual", scheme), dots: 7, line: false },
          ]}
          x={{ label: "pair" }}
          scales={{ y: { label: "difference", unit: effect.unit, include: [0] } }}
          data={[differences.map((_, index) => index + 1), differences]}
        />
      )}
    </Card>
  );
}

function Trials({ study, found }: { study: Study; found: CustomFound }) {
  const scheme = useScheme();
  const held = colorOf("velocity", scheme);
  const lost = scheme === "dark" ? "#ff8787" : "#c92a2a";
  const dots = { dots: 7, line: false } as const;
  const [first, second] = found.objectives.map((figure) => ({ figure, ...FIGURES[figure] }));
  const tried = study.trials.filter(({ state }) => state !== "pruned").length;
  if (!first) return null;
  return (
    <Card title="Trials" note={`${tried} tried, ${study.trials.length - tried} passed over`}>
      <div className="column">
        <Plot
          label={`${first.label} of each trial`}
          summary={`${tried} settings were tried`}
          height={170}
          series={[
            { label: "held", color: held, ...dots },
            { label: "did not hold", color: lost, ...dots },
          ]}
          x={{ label: "trial" }}
          scales={{ y: { label: first.label, unit: first.unit } }}
          data={overTrials(study, found, first.figure)}
        />
        {second && (
          <Plot
            label={`${second.label} over ${first.label}: the front of both`}
            summary={`${study.front.length} settings that none beats in both`}
            height={170}
            series={[
              { label: "held", color: held, ...dots },
              { label: "front", color: colorOf("acceleration", scheme), dots: 11, line: true },
            ]}
            x={{ label: first.label, unit: first.unit }}
            scales={{ y: { label: second.label, unit: second.unit } }}
            data={frontOfBoth(study, found)}
          />
        )}
        <Parallel study={study} held={held} lost={lost} figures={objectiveRanges(found)} />
      </div>
    </Card>
  );
}
