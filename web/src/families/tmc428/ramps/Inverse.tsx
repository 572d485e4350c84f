import { Button, Select } from "@mantine/core";
import { IconArrowRight } from "@tabler/icons-react";
import { api, type Schemas } from "../../../api/client";
import { Card } from "../../../lib/Card";
import { fixed, withUnit } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { type AxisScale, fromSteps, symbolOf, unitsFor } from "../../../lib/units";
import { useCalc } from "../../../lib/useCalc";
import { useSessionKept } from "../../../lib/useKept";
import { labelOf, type Model, type Pair, type RampDesign } from "./design";
import classes from "./Ramps.module.css";

interface Props {
  model: Model;
  scale: AxisScale;
  design: RampDesign;
  mechanics: Schemas["Mechanics"];
  reduction: number | null;
  onUse: (design: RampDesign, pair: Pair | null) => void;
}

interface Wanted {
  velocity: number;
  velocityUnit: string;
  acceleration: number;
  accelerationUnit: string;
}

type Answer = Schemas["RampInverseResult"];

function Part({ share }: { share: number }) {
  const percent = share * 100;
  const good = Math.abs(percent) < 1;
  return <span className={`num ${good ? "hint" : "m-0 caution text-12"}`}>{fixed(percent, 2, "%")}</span>;
}

function Field(props: {
  label: string;
  value: number;
  unit: string;
  units: string[];
  onValue: (value: number) => void;
  onUnit: (unit: string) => void;
}) {
  return (
    <div className={`${classes.wanted} grid end gap-4`}>
      <NumberField
        label={props.label}
        value={props.value}
        min={0}
        step={props.value / 20 || 1}
        onChange={props.onValue}
      />
      <Select
        aria-label={`Unit of the ${props.label.toLowerCase()}`}
        data={props.units.map((unit) => ({ value: unit, label: symbolOf(unit) }))}
        value={props.unit}
        comboboxProps={{ width: "max-content" }}
        onChange={(unit) => unit && props.onUnit(unit)}
      />
    </div>
  );
}

/** What another microstep resolution does to everything that counts in microsteps; null where it stays. */
export function microstepShift(now: number | null, then: number | null): string | null {
  if (now === null || then === null || now === then) return null;
  const [old, next] = [2 ** now, 2 ** then];
  const size = next > old ? `1/${next / old}` : `${old / next} times`;
  return (
    `Take over also changes ${old} to ${next} microsteps a full step. Positions, targets, soft limits and switch ` +
    `distances in µsteps keep their numbers and are then ${size} as far: set zero or search the reference again.`
  );
}

/** From speed and acceleration as an engineer wants them to the registers that come nearest. */
export function Inverse({ model, scale, design, mechanics, reduction, onUse }: Props) {
  const [wanted, setWanted] = useSessionKept<Wanted>("stepscope.ramps.wanted", {
    velocity: 300,
    velocityUnit: "rpm",
    acceleration: 2000,
    accelerationUnit: "rpm_per_s",
  });
  const velocityUnits = unitsFor("velocity", scale).filter((unit) => unit !== "chip");
  const accelerationUnits = unitsFor("acceleration", scale).filter((unit) => unit !== "chip");
  const velocityUnit = velocityUnits.includes(wanted.velocityUnit) ? wanted.velocityUnit : "pps";
  const accelerationUnit = accelerationUnits.includes(wanted.accelerationUnit) ? wanted.accelerationUnit : "pps2";

  const calculation = useCalc<Schemas["RampInverse"], Answer>(
    "ramp-inverse",
    {
      model,
      velocity: { value: wanted.velocity, unit: velocityUnit },
      acceleration: { value: wanted.acceleration, unit: accelerationUnit },
      mechanics,
      clock_hz: scale.clockHz,
      reduction,
    },
    (body, signal) => api.POST("/api/v1/calc/ramp-inverse", { body, signal }),
  );
  const { result, stale, error, retry } = calculation;

  const suggested: RampDesign | null = result
    ? {
        ...design,
        pulse_div: result.pulse_div,
        ramp_div: result.ramp_div,
        v_max: result.v_max,
        a_max: result.a_max,
        usrs: design.usrs === null ? null : (result.usrs ?? design.usrs),
      }
    : null;
  const then: AxisScale =
    suggested && suggested.usrs !== null ? { ...scale, microstepsPerFullStep: 2 ** suggested.usrs } : scale;
  const cells: [label: string, value: string][] = result
    ? [
        [labelOf(model, "pulse_div"), fixed(result.pulse_div)],
        [labelOf(model, "ramp_div"), fixed(result.ramp_div)],
        [labelOf(model, "v_max"), fixed(result.v_max)],
        [labelOf(model, "a_max"), fixed(result.a_max)],
        ...(design.usrs === null ? [] : [["usrs", fixed(result.usrs)] as [string, string]]),
        [labelOf(model, "pmul"), fixed(model === "tmc4210" ? result.p_mul : result.pmul)],
        [labelOf(model, "pdiv"), fixed(result.pdiv)],
      ]
    : [];

  const shift = suggested === null ? null : microstepShift(design.usrs, suggested.usrs);

  return (
    <Card title="From wanted motion" note="registers that come nearest">
      <div className="halves gap-8">
        <Field
          label="Speed"
          value={wanted.velocity}
          unit={velocityUnit}
          units={velocityUnits}
          onValue={(velocity) => setWanted({ ...wanted, velocity, velocityUnit })}
          onUnit={(unit) => setWanted({ ...wanted, velocityUnit: unit })}
        />
        <Field
          label="Acceleration"
          value={wanted.acceleration}
          unit={accelerationUnit}
          units={accelerationUnits}
          onValue={(acceleration) => setWanted({ ...wanted, acceleration, accelerationUnit })}
          onUnit={(unit) => setWanted({ ...wanted, accelerationUnit: unit })}
        />
      </div>
      {error !== null && <ProblemAlert error={error} doing="Looking for registers" retry={retry} />}
      {result && suggested && (
        <div className={stale ? "stale" : undefined} aria-busy={stale}>
          <dl className="stacked lines-12 my-8">
            {cells.map(([label, value]) => (
              <div key={label}>
                <dt className="mono">{label}</dt>
                <dd className="num text-13">{value}</dd>
              </div>
            ))}
          </dl>
          <div className="mid lines-8 text-12">
            <span>achieved</span>
            <span className="num">
              {withUnit(fromSteps(result.achieved_velocity_pps, velocityUnit, then, "velocity"), velocityUnit)}
            </span>
            <Part share={result.velocity_error} />
            <span className="num">
              {withUnit(
                fromSteps(result.achieved_acceleration_pps2, accelerationUnit, then, "acceleration"),
                accelerationUnit,
              )}
            </span>
            <Part share={result.acceleration_error} />
            <Button
              size="compact-xs"
              variant="light"
              ml="auto"
              rightSection={<IconArrowRight size={14} aria-hidden />}
              disabled={stale}
              onClick={() =>
                onUse(
                  suggested,
                  result.pmul === null || result.pdiv === null ? null : { pmul: result.pmul, pdiv: result.pdiv },
                )
              }
            >
              Take over
            </Button>
          </div>
          {shift !== null && (
            <p className="m-0 caution text-12" role="status" data-testid="microstep-shift">
              {shift}
            </p>
          )}
          {result.warnings.map((warning) => (
            <p key={warning} className="m-0 caution text-12">
              {warning}
            </p>
          ))}
        </div>
      )}
    </Card>
  );
}
