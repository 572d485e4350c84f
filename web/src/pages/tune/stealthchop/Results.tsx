import { Text } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import { FiguresTable } from "../FiguresTable";
import type { Study } from "../study";
import { TrialsCard } from "../trials/TrialsCard";
import { joltsOf, namedOf, pointsOf, reachOf, type StealthFound } from "./tried";

/** How much the change of choppers jolted at which speed, which amplitudes fit, and how sure that is. */
export function Results({ study }: { study: Study }) {
  const found = study.stealthchop;
  if (!found || found.before === null) return null;
  return (
    <>
      <Found found={found} />
      <TrialsCard trials={pointsOf(study, found)} />
    </>
  );
}

function Found({ found }: { found: StealthFound }) {
  const scheme = useScheme();
  const percent = (share: number | null) => (share === null ? "not told" : `${compact(100 * share, 3)} %`);
  return (
    <Card title="StealthChop" note={`${found.tried.length} tried`}>
      <Plot
        label="Jolt over switch-over speed"
        height={190}
        series={[
          { label: "tried", color: colorOf("velocity", scheme), dots: 7, line: false },
          { label: "before", color: colorOf("residual", scheme), dots: 9, line: false },
          { label: "allowed", color: colorOf("target", scheme) },
        ]}
        x={{ label: "switch-over", unit: "turns/s" }}
        scales={{ y: { label: "jolt", unit: "full steps", include: [0] } }}
        data={joltsOf(found)}
      />
      <FiguresTable
        label="Settings of StealthChop"
        minWidth={420}
        heads={["", "PWM_OFS", "PWM_GRAD", "Up to", "Jolt [full steps]", "Off by"]}
        rows={namedOf(found).map(([name, one]) => [
          name,
          `${one.offset ?? "none"}`,
          `${one.gradient ?? "none"}`,
          reachOf(one, (value) => compact(value, 3)),
          compact(one.jolt_fullsteps, 3),
          percent(one.added_share),
        ])}
      />
      {found.offset_auto !== null && (
        <Text size="sm">
          The chip tuned PWM_OFS_AUTO {found.offset_auto}
          {found.gradient_auto !== null && ` and PWM_GRAD_AUTO ${found.gradient_auto}`} by itself.
        </Text>
      )}
      {found.effects.map((effect) => {
        const times = effect.name === "added" ? 100 : 1;
        return (
          <Text size="sm" key={effect.name}>
            {effect.name === "added" ? "Amplitude off by" : "Jolt"}, new less old, {effect.pairs} pairs:{" "}
            {compact(times * effect.difference, 3)} {effect.name === "added" ? "%" : "full steps"} (95 %:{" "}
            {compact(times * effect.interval.low, 3)} to {compact(times * effect.interval.high, 3)}), p{" "}
            {compact(effect.p, 2)}.
          </Text>
        );
      })}
    </Card>
  );
}
