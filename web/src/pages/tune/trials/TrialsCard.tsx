import type { ReactNode } from "react";
import { Card } from "../../../lib/Card";
import { counted } from "../../../lib/format";
import { colorOf } from "../../../lib/palette";
import { symbolOf } from "../../../lib/units";
import { useScheme } from "../../../lib/useScheme";
import { Plot, type PlotProps } from "../../../plots/Plot";
import { Parallel } from "./Parallel";
import { frontOf, historyOf, LOST, movedOf, type Setting, spaceOf, type Trials } from "./points";
import { useStateColors } from "./useStateColors";

interface OfTrials {
  trials: Trials;
}

const DOTS = { dots: 7, line: false } as const;

/** Series of what held and of what did not; where all held the legend has no place for that. */
function useStates({ points, lost = LOST }: Trials) {
  const colors = useStateColors();
  const unnamed = points.every(({ state }) => state !== "lost");
  return [
    { label: "held", color: colors.held, ...DOTS },
    { label: lost, color: colors.lost, unnamed, ...DOTS },
  ] as const;
}

/** What was tried, live: the first figure over trials, the space of two settings, and all settings and figures at once. */
export function TrialsCard({ trials, space, children }: OfTrials & { space?: boolean; children?: ReactNode }) {
  const passed = trials.points.filter(({ state }) => state === "pruned").length;
  const note = `${trials.points.length - passed} tried${passed > 0 ? `, ${passed} passed over` : ""}`;
  if (trials.points.length === 0) return null;
  return (
    <Card title="Trials" note={note}>
      <div className="column">
        <History trials={trials} />
        {space && trials.settings.length >= 2 && <Space trials={trials} />}
        <Together trials={trials} />
        {children}
      </div>
    </Card>
  );
}

/** All settings and figures of each trial: across parallel axes; of one setting the figure over it. */
export function Together({ trials, label }: OfTrials & { label?: string | undefined }) {
  return trials.settings.length >= 2 ? <Parallel trials={trials} label={label} /> : <Space trials={trials} />;
}

function History({ trials }: OfTrials) {
  const [held, lost] = useStates(trials);
  const [figure] = trials.figures;
  if (!figure) return null;
  return (
    <Plot
      title={titleOf(figure)}
      label={`${capital(figure.name)} of each trial`}
      summary={`tried: ${counted(movedOf(trials).length, "setting")}`}
      height={170}
      series={[held, lost, { label: "best so far", color: held.color, stepped: true }]}
      x={{ label: "trial" }}
      scales={{ y: { label: figure.name, unit: figure.unit } }}
      data={historyOf(trials)}
    />
  );
}

function Space({ trials }: OfTrials) {
  const series = useStates(trials);
  const [x, y] = [...trials.settings, ...trials.figures];
  if (!x || !y) return null;
  return (
    <Plot
      title={titleOf(y)}
      label={`${y.name} over ${x.name} of each trial`}
      height={200}
      series={series}
      x={{ label: x.name, unit: x.unit }}
      scales={{ y: { label: y.name, unit: y.unit } }}
      data={spaceOf(trials)}
    />
  );
}

interface FrontProps extends OfTrials, Pick<PlotProps, "summary" | "onCursor"> {
  front: readonly number[];
  chosen?: number | null;
}

/** The second figure over the first: what none beats in both is joined. */
export function FrontPlot({ trials, front, chosen = null, ...more }: FrontProps) {
  const scheme = useScheme();
  const [held] = useStates(trials);
  const [x, y] = trials.figures;
  if (!x || !y) return null;
  const marked = { label: "chosen", color: colorOf("residual", scheme), dots: 15, line: false };
  return (
    <Plot
      title={titleOf(y)}
      label={`${capital(y.name)} over ${x.name}: the front of both`}
      height={190}
      series={[
        held,
        { label: "front", color: colorOf("predicted_position", scheme), dots: 9, line: true },
        ...(chosen === null ? [] : [marked]),
      ]}
      x={{ label: x.name, unit: x.unit }}
      scales={{ y: { label: y.name, unit: y.unit } }}
      data={frontOf(trials, front, chosen)}
      {...more}
    />
  );
}

/** What a plot's values are: the page writes no name at its upright axis. */
function titleOf({ name, unit }: Setting): string {
  return unit === "" ? name : `${name} [${symbolOf(unit)}]`;
}

function capital(name: string): string {
  return name.charAt(0).toUpperCase() + name.slice(1);
}
