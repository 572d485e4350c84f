import { Button, Center, Slider } from "@mantine/core";
import type { Schemas } from "../../../api/client";
import { Card } from "../../../lib/Card";
import { compact, duration, fixed } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import type { Calculation } from "../../../lib/useCalc";
import { WarningList } from "../../../lib/Warnings";
import { Savable } from "../../../plots/Savable";
import { CandidateChart } from "./CandidateChart";
import { idealP, labelOf, type Model, type Pair, pOf, type RampDesign } from "./design";
import classes from "./Ramps.module.css";

interface Props {
  model: Model;
  design: RampDesign;
  calculation: Calculation<Schemas["PmulPdivResult"]>;
  pair: Pair | null;
  byHand: boolean;
  onPair: (pair: Pair | null) => void;
  reduction: number | null;
  onReduction: (reduction: number | null) => void;
}

/** By how much the data sheets take p back: about 5 % (TMC428, 8.11.1) and 1 % (TMC4210, 6.1.9). */
export const SHEET_REDUCTION: Record<Model, number> = { tmc428: 0.05, tmc429: 0.01, tmc4210: 0.01 };

/** The pair of pmul and pdiv: what is needed, what can be had, and the choice. */
export function PairSection(props: Props) {
  const { model, design, calculation, pair, byHand, onPair, reduction, onReduction } = props;
  const { result, stale, error, retry } = calculation;
  const sheet = SHEET_REDUCTION[model];
  const percent = (reduction ?? sheet) * 100;
  const chosen = result?.candidates.find((entry) => entry.pmul === pair?.pmul && entry.pdiv === pair.pdiv);
  const none = result !== undefined && !stale && result.pmul === null;
  const recommended =
    result && result.pmul !== null && result.pdiv !== null ? { pmul: result.pmul, pdiv: result.pdiv } : null;
  const ideal = result?.p_ideal ?? idealP(design);
  const base = model === "tmc4210" ? 128 : 0;
  const other = byHand && !(recommended?.pmul === pair?.pmul && recommended?.pdiv === pair?.pdiv);
  const quality = pair && ideal > 0 ? pOf(pair) / ideal : null;

  return (
    <Card
      title="Braking factor p"
      note={
        <span>
          p = {labelOf(model, "a_max")} / (128 · 2^({labelOf(model, "ramp_div")} − {labelOf(model, "pulse_div")})) ={" "}
          <span className="num">{compact(ideal, 5)}</span>
        </span>
      }
      actions={
        <Button size="compact-xs" variant="default" disabled={!other} onClick={() => onPair(null)}>
          Recommended pair
        </Button>
      }
    >
      <div className="control-line mb-4">
        <span className="text-12 mono">reduction</span>
        <Slider
          min={0}
          max={20}
          step={0.1}
          value={percent}
          onChange={(value) => onReduction(Math.abs(value - sheet * 100) < 0.05 ? null : value / 100)}
          marks={[{ value: sheet * 100, label: `data sheet ${fixed(sheet * 100, 0, "%")}` }]}
          thumbLabel="Reduction of p in percent"
          className={classes.markedSlider ?? ""}
        />
        <NumberField
          aria-label="Reduction of p in percent"
          value={percent}
          unit="%"
          min={0}
          max={99}
          step={0.1}
          onChange={(value) => onReduction(Math.abs(value - sheet * 100) < 1e-9 ? null : value / 100)}
        />
      </div>
      {error !== null && <ProblemAlert error={error} doing="Designing the pair" retry={retry} />}
      <div className={stale ? "stale" : undefined} aria-busy={stale}>
        <div className="room lines-12 baseline text-12">
          {pair ? (
            <>
              <span className="num bold">
                {labelOf(model, "pmul")} {pair.pmul + base} · {labelOf(model, "pdiv")} {pair.pdiv}
              </span>
              <span className="num">p {compact(pOf(pair), 5)}</span>
              <span className={`num ${quality !== null && quality > 1 ? "m-0 caution text-12" : ""}`}>
                q {fixed(quality, 4)}
              </span>
              <span className="num">
                {chosen
                  ? chosen.overshoot_steps === null
                    ? "never settles"
                    : `overshoot ${fixed(chosen.overshoot_steps)} µsteps, settles in ${duration(chosen.settling_s)}`
                  : ""}
              </span>
              <span className="hint">{other ? "own choice" : "recommended"}</span>
            </>
          ) : none ? (
            <strong className="m-0 caution text-12">No pair represents this p</strong>
          ) : (
            <span className="hint">looking for a pair</span>
          )}
        </div>
        {result && result.candidates.length > 0 ? (
          <Savable low name="Pairs by quality">
            <figure className="m-0">
              <CandidateChart
                model={model}
                candidates={result.candidates}
                chosen={pair}
                recommended={recommended}
                onChoose={onPair}
              />
              <figcaption className="lines-12 hint m-0" aria-hidden>
                <span className="inline gap-4">
                  <svg width="10" height="10" aria-hidden="true">
                    <circle className="fill-accent" cx="5" cy="5" r="4" />
                  </svg>
                  no overshoot
                </span>
                <span className="inline gap-4">
                  <svg width="10" height="10" aria-hidden="true">
                    <circle className={classes.pairOver} cx="5" cy="5" r="3.5" />
                  </svg>
                  overshoots
                </span>
                <span className="inline gap-4">
                  <svg width="14" height="14" aria-hidden="true">
                    <circle className="fill-accent" cx="7" cy="7" r="3.5" />
                    <circle className="fill-none stroke-text stroke-1" cx="7" cy="7" r="6" />
                  </svg>
                  recommended
                </span>
                <span>shaded: 0.95 &lt; q &lt; 1</span>
                <span>over: µsteps beyond the target</span>
                <span>below: {labelOf(model, "pmul")}</span>
              </figcaption>
            </figure>
          </Savable>
        ) : (
          <Center mih={232} className="dim text-13 centered">
            {none
              ? "Without a pair the chip cannot brake to the target. Change a_max, or bring ramp_div and pulse_div closer together."
              : ""}
          </Center>
        )}
        <WarningList className="room list" texts={result?.warnings ?? []} />
      </div>
    </Card>
  );
}
