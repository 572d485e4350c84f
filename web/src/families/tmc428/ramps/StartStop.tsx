import { Button, Text } from "@mantine/core";
import { api, type Schemas } from "../../../api/client";
import { Card } from "../../../lib/Card";
import { compact, duration, fixed, withUnit } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { FIELDS, MOTOR, type Motor, type MotorKey, motorBody } from "../../../lib/ramp/motor";
import { type AxisScale, fromSteps } from "../../../lib/units";
import { useCalc } from "../../../lib/useCalc";
import { useSessionKept } from "../../../lib/useKept";
import { WarningList } from "../../../lib/Warnings";

interface Props {
  /** whose motor is kept */
  own: string;
  /** the planned ramp, as POST /calc/ramp takes it; null while it is not known */
  ramp: { parameters: Record<string, number | string>; distance: number } | null;
  scale: AxisScale;
  unit: string;
  vMin: number;
  onVMin: (vMin: number) => void;
}

const NEEDED: ReadonlySet<MotorKey> = new Set([
  "holdingNm",
  "ratedA",
  "currentA",
  "inertiaGcm2",
  "frictionNm",
  "loadNm",
]);

/** From how fast the motor may be stopped dead at its target, and v_min against that. */
export function StartStop({ own, ramp, scale, unit, vMin, onVMin }: Props) {
  const [kept, setMotor] = useSessionKept<Motor>(`stepscope.ramps.motor.${own}`, MOTOR);
  const motor = motorBody({ ...kept, shown: true }, scale);
  const found = useCalc<Schemas["StartStop"], Schemas["StartStopResult"]>(
    "start-stop",
    ramp === null || motor === null ? null : { ...ramp, motor },
    (body, signal) => api.POST("/api/v1/calc/start-stop", { body, signal }),
  );
  const { result, stale, error, retry } = found;
  const speed = (pps: number) => withUnit(fromSteps(pps, unit, scale, "velocity"), unit);
  return (
    <Card
      title="Start-stop speed"
      note={
        result ? (
          <span className={stale ? "stale" : result.keeps_steps ? undefined : "m-0 caution text-12"}>
            {result.keeps_steps ? "v_min keeps every step" : "v_min loses steps"}
          </span>
        ) : (
          ""
        )
      }
      actions={
        <Button
          size="compact-xs"
          variant="default"
          disabled={!result || stale || result.suggested_chip === vMin}
          onClick={() => result && onVMin(result.suggested_chip)}
          data-testid="use-v-min"
        >
          {result ? `v_min ${result.suggested_chip}` : "v_min"}
        </Button>
      }
    >
      <div className="halves gap-8">
        {FIELDS.filter(({ key }) => NEEDED.has(key)).map(({ key, label, unit: of, title, zero }) => (
          <NumberField
            key={key}
            label={label}
            title={title}
            unit={of}
            value={kept[key]}
            min={zero ? 0 : 1e-6}
            max={1e6}
            step={kept[key] / 20 || 0.01}
            onChange={(value) => setMotor({ ...kept, [key]: value })}
          />
        ))}
      </div>
      {error !== null && <ProblemAlert error={error} doing="Judging v_min" retry={retry} />}
      {result && (
        <div className={stale ? "stale" : undefined} aria-busy={stale}>
          <table className="figures mt-4" data-testid="start-stop">
            <tbody>
              <tr>
                <th scope="row">The motor can stop dead from</th>
                <td className="num">
                  {speed(result.limit_pps)}, v_min {compact(result.limit_chip)}
                </td>
              </tr>
              <tr>
                <th scope="row">v_min is</th>
                <td className="num">
                  {speed(result.v_min_pps)}
                  {result.share === null ? "" : `, ${fixed(100 * result.share, 0, "%")} of that`}
                </td>
              </tr>
              <tr>
                <th scope="row">The move takes</th>
                <td className="num">
                  {duration(result.duration_s)}, with v_min 1 {duration(result.duration_least_s)}, with{" "}
                  {result.suggested_chip} {duration(result.duration_suggested_s)}
                </td>
              </tr>
            </tbody>
          </table>
          <WarningList texts={result.warnings} />
        </div>
      )}
      <Text className="hint mt-4">
        A rotor stopped at once swings about its field and must not pass the next maximum of the torque. Damping is left
        out, load counts against the motion. The chip itself accelerates from 0: v_min is where it stops, not where it
        starts. The recipe of the TMC4210 sheet for a start in a jump (9.2) is not in the text at hand.
      </Text>
    </Card>
  );
}
