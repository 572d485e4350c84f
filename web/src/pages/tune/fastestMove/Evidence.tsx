import { Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import type { Study } from "../study";
import { Tiles } from "../Tiles";

interface Props {
  study: Study;
  evidence: NonNullable<Study["evidence"]>;
}

/** How sure it is: the difference of each pair, its mean with the interval, and what the runs bound. */
export function Evidence({ study, evidence }: Props) {
  const scheme = useScheme();
  const { low, high } = evidence.interval_s;
  const { deviation } = evidence;
  const differences = study.pairs.map(({ winner_s: winner, baseline_s: baseline }) => (winner - baseline) * 1e3);
  const summary = `${compact(evidence.difference_s * 1e3, 4, "ms")} on average, 95 %: ${compact(low * 1e3)} to ${compact(high * 1e3, 4, "ms")}`;
  return (
    <Card title="How sure" note={evidence.significant || deviation?.significant ? "better" : "not shown to be better"}>
      <Tiles
        label="The best setting against the one before"
        figures={[
          ["time of a move", compact(evidence.share * 100, 3, "%")],
          ["before", compact(evidence.baseline_s, 3, "s")],
          ["best", compact(evidence.winner_s, 3, "s")],
          ...(deviation === null
            ? []
            : ([["deviation under way", compact(deviation.share * 100, 3, "%")]] as [string, string][])),
          ["runs that lost steps", `0 of ${evidence.runs}`],
        ]}
      />
      <Text size="sm">
        {summary}; p {compact(evidence.p, 2)} of {evidence.pairs} pairs. Steps lost in 0 of {evidence.runs} runs: a rate
        below {compact(evidence.loss_rate_max * 100, 2, "%")}, at 95 %.
      </Text>
      {deviation && (
        <Text size="sm">
          Peak deviation {compact(deviation.baseline_fullsteps, 3)} before, {compact(deviation.winner_fullsteps, 3)}{" "}
          full steps with the best: {compact(deviation.difference_fullsteps, 3)} on average, 95 %:{" "}
          {compact(deviation.interval_fullsteps.low, 3)} to{" "}
          {compact(deviation.interval_fullsteps.high, 3, "full steps")}; p {compact(deviation.p, 2)}.
        </Text>
      )}
      <Plot
        label="Difference of each pair"
        summary={summary}
        height={150}
        series={[{ label: "new less old", unit: "ms", color: colorOf("residual", scheme), dots: 7, line: false }]}
        x={{ label: "pair" }}
        scales={{ y: { label: "difference", unit: "ms", include: [0] } }}
        data={[differences.map((_, index) => index + 1), differences]}
      />
    </Card>
  );
}
