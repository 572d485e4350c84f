import { useRef, useState } from "react";
import { Card } from "../../../lib/Card";
import { counted } from "../../../lib/format";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import type { Study } from "../study";
import { FrontPlot } from "../trials/TrialsCard";
import type { Changes } from "../useStudies";
import { FrontChoice } from "./FrontChoice";
import { choicesOf, nearestOf, pointsOf } from "./trials";

interface Props {
  study: Study;
  changes: Pick<Changes, "trial" | "start">;
}

/** The front of two objectives: one of its settings is chosen, in the plot or the list, and taken or proved. */
export function Front({ study, changes }: Props) {
  const [picked, setPicked] = useState<number | null>(null);
  const under = useRef<number | null>(null);
  const choices = choicesOf(study);
  const find = (number: number | null) => choices.find((trial) => trial.number === number);
  const chosen = find(picked) ?? find(study.best) ?? choices[0];
  if (chosen === undefined) return null;
  const pick = () => {
    const nearest = under.current === null ? undefined : nearestOf(choices, under.current);
    if (nearest) setPicked(nearest.number);
  };
  return (
    <Card title="Time and deviation" note={`${counted(choices.length, "setting")} that none beats in both`}>
      {/* biome-ignore lint/a11y/noStaticElementInteractions: a shortcut for the mouse to the list below */}
      {/* biome-ignore lint/a11y/useKeyWithClickEvents: a shortcut for the mouse to the list below */}
      <div onClick={pick}>
        <FrontPlot
          trials={pointsOf(study)}
          front={study.front}
          chosen={chosen.number}
          summary={`Trial ${chosen.number} is chosen`}
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
