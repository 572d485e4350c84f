import { useRef, useState } from "react";
import { Card } from "../../../lib/Card";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import type { Study } from "../study";
import type { Changes } from "../useStudies";
import { FrontChoice } from "./FrontChoice";
import { choicesOf, frontOf, nearestOf } from "./trials";

interface Props {
  study: Study;
  changes: Pick<Changes, "trial" | "start">;
}

/** The front of two objectives: one of its settings is chosen, in the plot or the list, and taken or proved. */
export function Front({ study, changes }: Props) {
  const scheme = useScheme();
  const [picked, setPicked] = useState<number | null>(null);
  const under = useRef<number | null>(null);
  const choices = choicesOf(study);
  const find = (number: number | null) => choices.find((trial) => trial.number === number);
  const chosen = find(picked) ?? find(study.best) ?? choices[0];
  if (chosen === undefined) return null;
  const held = colorOf("velocity", scheme);
  const dots = { dots: 7, line: false } as const;
  const pick = () => {
    const nearest = under.current === null ? undefined : nearestOf(choices, under.current);
    if (nearest) setPicked(nearest.number);
  };
  return (
    <Card title="Time and deviation" note={`${choices.length} settings that none beats in both`}>
      {/* biome-ignore lint/a11y/noStaticElementInteractions: a shortcut for the mouse to the list below */}
      {/* biome-ignore lint/a11y/useKeyWithClickEvents: a shortcut for the mouse to the list below */}
      <div onClick={pick}>
        <Plot
          label="Deviation over time: the front of both"
          summary={`Trial ${chosen.number} is chosen`}
          height={190}
          series={[
            { label: "held", color: held, ...dots },
            { label: "front", color: colorOf("acceleration", scheme), dots: 9, line: true },
            { label: "chosen", color: colorOf("residual", scheme), dots: 15, line: false },
          ]}
          x={{ label: "time", unit: "s" }}
          scales={{ y: { label: "deviation", unit: "full steps" } }}
          data={frontOf(study.trials, study.front, chosen.number)}
          onCursor={(at) => {
            under.current = at === null ? null : at.x;
          }}
        />
      </div>
      <FrontChoice
        study={study}
        chosen={chosen}
        onPick={setPicked}
        onTake={(trial) => changes.trial.mutate({ id: study.id, trial })}
        onProve={(proof) => changes.start.mutate(proof)}
        busy={changes.trial.isPending || changes.start.isPending}
      />
      {changes.trial.error && changes.trial.variables?.id === study.id && (
        <ProblemAlert error={changes.trial.error} doing="Taking it" onClose={() => changes.trial.reset()} />
      )}
    </Card>
  );
}
