import { Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { FiguresTable } from "../FiguresTable";
import type { Study } from "../study";
import { TrialsCard } from "../trials/TrialsCard";
import { type ChopperFound, namedOf, pointsOf, rippleOf } from "./tried";

/** How much the shaft shook by which setting, and how sure the best one is. */
export function Results({ study }: { study: Study }) {
  const found = study.chopper;
  if (!found || found.before === null) return null;
  return (
    <>
      <Found found={found} />
      <TrialsCard trials={pointsOf(study, found)} />
    </>
  );
}

function Found({ found }: { found: ChopperFound }) {
  const scheme = useScheme();
  const { effect } = found;
  return (
    <Card title="Chopper" note={`${found.tried.length} tried`}>
      <Plot
        label="Ripple over hysteresis"
        height={190}
        series={[
          { label: "tried", color: colorOf("velocity", scheme), dots: 7, line: false },
          { label: "before", color: colorOf("residual", scheme), dots: 9, line: false },
        ]}
        x={{ label: "hysteresis" }}
        scales={{ y: { label: "ripple", unit: "full steps" } }}
        data={rippleOf(found)}
      />
      <FiguresTable
        label="Choppers"
        minWidth={320}
        heads={["", "TOFF", "TBL", "Hysteresis", "Ripple", "Chopper, about"]}
        rows={namedOf(found).map(([name, one]) => [
          name,
          `${one.off}`,
          `${one.blank}`,
          `${one.hysteresis}`,
          `${compact(one.ripple_fullsteps, 3)} full steps`,
          compact(one.chopper_hz / 1e3, 3, "kHz"),
        ])}
      />
      {effect && (
        <Text size="sm">
          New less old, {effect.pairs} pairs: {compact(effect.difference_fullsteps, 3)} full steps (95 %:{" "}
          {compact(effect.interval_fullsteps.low, 3)} to {compact(effect.interval_fullsteps.high, 3)}), p{" "}
          {compact(effect.p, 2)}.
        </Text>
      )}
    </Card>
  );
}
