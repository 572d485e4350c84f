import { Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import type { Study } from "../study";
import { Parallel } from "./Parallel";
import { historyOf, spaceOf } from "./trials";

/** What was tried, live: times over trials, the space of the settings, and all at once. */
export function TrialPlots({ study }: { study: Study }) {
  const scheme = useScheme();
  const held = colorOf("velocity", scheme);
  const lost = scheme === "dark" ? "#ff8787" : "#c92a2a";
  const dots = { dots: 7, line: false } as const;
  const names = Object.keys(study.units);
  const tried = study.trials.filter(({ state }) => state !== "pruned").length;
  return (
    <Card title="Trials" note={`${tried} tried, ${study.trials.length - tried} passed over`}>
      <div className="column">
        <Plot
          label="Time of each trial"
          summary={`${tried} settings were tried`}
          height={170}
          series={[
            { label: "held", color: held, ...dots },
            { label: "lost steps (its ramp)", color: lost, ...dots },
            { label: "best so far", color: held, stepped: true },
          ]}
          x={{ label: "trial" }}
          scales={{ y: { label: "time", unit: "s" } }}
          data={historyOf(study.trials)}
        />
        {names.length >= 2 && (
          <Plot
            label={`${names[1]} over ${names[0]} of each trial`}
            height={200}
            series={[
              { label: "held", color: held, ...dots },
              { label: "lost steps", color: lost, ...dots },
            ]}
            x={{ label: names[0] ?? "", unit: study.units[names[0] ?? ""] ?? "" }}
            scales={{ y: { label: names[1] ?? "", unit: study.units[names[1] ?? ""] ?? "" } }}
            data={spaceOf(study.trials, names)}
          />
        )}
        <Parallel study={study} held={held} lost={lost} />
        <Text size="sm" className="dim">
          Way of the motor so far: {compact(study.way_fullsteps)} full steps in {study.runs} runs.
        </Text>
      </div>
    </Card>
  );
}
