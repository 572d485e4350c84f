import { Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { FiguresTable } from "../FiguresTable";
import type { Study } from "../study";
import { Parallel } from "../trials/Parallel";
import type { Changes } from "../useStudies";
import {
  aloneText,
  distributionsOf,
  pointsOf,
  rateText,
  rocOf,
  type StallFound,
  type StallSpeed,
  thresholdText,
} from "./rates";
import { TakeOwn } from "./TakeOwn";

/** What came of each speed: both rates, how load values are distributed, and what each threshold would do. */
export function Results({ study, changes }: { study: Study; changes: Changes }) {
  const found = study.stallguard;
  if (!found) return null;
  return (
    <>
      <Rates found={found} study={study} changes={changes} />
      {found.speeds
        .filter(({ roc }) => roc.length > 0)
        .map((speed) => (
          <Distributions key={speed.speed_rps} speed={speed} level={speed.own?.level ?? found.level} />
        ))}
    </>
  );
}

function Rates({ found, study, changes }: { found: StallFound; study: Study; changes: Changes }) {
  const { id } = study;
  return (
    <Card title="How sure" note={`StallGuard${found.generation}`}>
      <FiguresTable
        label="False and missed stalls at each speed"
        minWidth={500}
        heads={["turns/s", "Threshold", "False stalls", "Missed", "Why not", "Alone, not held out"]}
        rows={found.speeds.map((at) => {
          const proved = thresholdText(at, study);
          const told = proved ? ["", ""] : [at.why, aloneText(at.alone)];
          return [compact(at.speed_rps), proved, rateText(at.false), rateText(at.missed), ...told];
        })}
      />
      <Text size="sm" className="dim">
        Of held-out runs: free ones of {compact(found.run_fullsteps)} full steps, and into the stop by{" "}
        {compact(found.push_fullsteps)}, by the threshold beside. Bounds are one-sided, 95 %. Alone: the threshold that
        suits that speed best, by the runs it was chosen by; told where nothing is proved.
      </Text>
      <TakeOwn
        study={study}
        found={found}
        onTake={(trial) => changes.trial.mutate({ id, trial })}
        busy={changes.trial.isPending}
      />
      {changes.trial.error && changes.trial.variables?.id === id && (
        <ProblemAlert error={changes.trial.error} doing="The setting" onClose={() => changes.trial.reset()} />
      )}
      <Parallel trials={pointsOf(study)} label="Settings that were tried on held-out runs" />
    </Card>
  );
}

function Distributions({ speed, level }: { speed: StallSpeed; level: number | null }) {
  const scheme = useScheme();
  const stop = scheme === "dark" ? "#ff8787" : "#c92a2a";
  const name = `${compact(speed.speed_rps)} turns/s`;
  const lowest = speed.free.length > 0 ? Math.min(...speed.free) : Number.NaN;
  const highest = speed.stops.length > 0 ? Math.max(...speed.stops) : Number.NaN;
  return (
    <Card title={`At ${name}`}>
      <div className="column">
        <Plot
          label={`Load values at ${name}`}
          summary={`Free runs fall to ${compact(lowest)}, stalls come to ${compact(highest)} at the least`}
          height={170}
          series={[
            { label: "free runs", color: colorOf("velocity", scheme), stepped: true },
            { label: "against the stop", color: stop, stepped: true },
          ]}
          x={{ label: "load value at threshold 0" }}
          scales={{ y: { label: "share", include: [0] } }}
          marks={
            level === null
              ? []
              : [{ id: "level", x: level, color: colorOf("target_position", scheme), label: "a stall", fixed: true }]
          }
          data={distributionsOf(speed)}
        />
        <Plot
          label={`Missed over false stalls at ${name}`}
          height={150}
          legend
          series={[
            {
              label: "missed stalls, share: each threshold",
              color: colorOf("load_value", scheme),
              dots: 5,
              line: true,
            },
          ]}
          x={{ label: "false stalls, share of free runs" }}
          scales={{ y: { label: "missed", include: [0, 1] } }}
          data={rocOf(speed)}
        />
      </div>
    </Card>
  );
}
