import { Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact, counted } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { FiguresTable } from "../FiguresTable";
import type { Study } from "../study";
import { FrontPlot, TrialsCard } from "../trials/TrialsCard";
import { FIGURES } from "./form";
import { type CustomFound, evidenceRows, pointsOf } from "./found";

/** How sure the best setting is, and what was tried. */
export function Results({ study }: { study: Study }) {
  const found = study.custom;
  if (!found || found.before === null) return null;
  const trials = pointsOf(study, found);
  return (
    <>
      {found.effects.length > 0 && <Evidence found={found} better={study.improved === true} />}
      <TrialsCard trials={trials} space>
        <FrontPlot
          trials={trials}
          front={study.front}
          summary={`${counted(study.front.length, "setting")} that none beats in both`}
        />
      </TrialsCard>
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
        {counted(found.pairs.length, "pair")}; no step lost in {counted(found.runs, "run")}: a rate below{" "}
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
