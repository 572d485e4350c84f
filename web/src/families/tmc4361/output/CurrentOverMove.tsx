import { Text } from "@mantine/core";
import { useLocalStorage } from "@mantine/hooks";
import { useMemo, useState } from "react";
import { api, type Schemas } from "../../../api/client";
import type { Device } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { duration, fixed } from "../../../lib/format";
import { Loading } from "../../../lib/Loading";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf } from "../../../lib/palette";
import type { ChipRows } from "../../../lib/rows/useChipRows";
import { useCalc } from "../../../lib/useCalc";
import { useScheme } from "../../../lib/useScheme";
import { WarningLines } from "../../../lib/Warnings";
import { Plot } from "../../../plots/Plot";
import { type Course, moveOf, rowsOf, scalesOf } from "./scales";

const SAMPLES = 900;
const ask = (body: Schemas["DriveCurrent"], signal: AbortSignal): Promise<Course> =>
  api.POST("/api/v1/calc/drive-current", { body, signal });

interface Props {
  chip: ChipRows;
  clockHz: number;
  axis: Device["axes"][number];
  /** what the full scale is kept for */
  of: string;
}

/** Current and velocity over a move with the chip's ramp, with what is staged. */
export function CurrentOverMove({ chip, clockHz, axis, of }: Props) {
  const scheme = useScheme();
  const known = axis.limits?.current_full_scale_a ?? null;
  const [own, setOwn] = useLocalStorage<number | null>({ key: `stepscope.full-scale.${of}`, defaultValue: null });
  const fullScale = known ?? own;
  const move = moveOf(chip, clockHz);
  const [way, setWay] = useState<number | null>(null);
  const distance = way ?? move.showing;
  const scales = scalesOf(chip);
  const loop = chip.planned("CURRENT_CONF", "closed_loop_scale_en") === 1;
  const { result, stale, error, retry } = useCalc(
    "drive-current",
    scales && {
      ramp: { model: "s_ramp" as const, parameters: move.parameters, distance, samples: SAMPLES },
      scales,
      clock_hz: clockHz,
      full_scale_rms_a: fullScale,
    },
    ask,
  );
  const shown = useMemo(() => {
    if (!result) return null;
    const amperes = result.current_rms_a ?? result.scale.map((scale) => ((scale + 1) / 256) * 100);
    return { current: [result.time_s, amperes] as const, velocity: [result.time_s, result.velocity_pps] as const };
  }, [result]);
  const unit = result?.current_rms_a ? "A rms" : "%";
  const color = colorOf("current_scale", scheme);
  return (
    <Card
      title="Current over a move"
      note={
        move.assumed ? "with a ramp to begin with: the chip holds none" : "with the chip's ramp, and what is staged"
      }
      actions={
        <>
          <NumberField
            aria-label="Distance of the move"
            unit="µsteps"
            w={130}
            integer
            value={distance}
            min={1}
            max={2 ** 30}
            onChange={setWay}
          />
          <NumberField
            aria-label="Full scale of the driver"
            title={
              known === null
                ? "Coil current at scale 255: what the driver and its sense resistors make of it"
                : "as the axis's limits have it"
            }
            unit="A rms"
            placeholder="full scale"
            w={160}
            value={fullScale}
            min={0.01}
            max={100}
            step={0.1}
            disabled={known !== null}
            onChange={setOwn}
            onClear={() => setOwn(null)}
          />
        </>
      }
    >
      {error !== null && <ProblemAlert error={error} doing="Reckoning the current" retry={retry} />}
      {loop && (
        <Text className="caution text-12" role="status">
          closed_loop_scale_en is set: in closed loop the deviation sets the scale, and nothing of this applies.
        </Text>
      )}
      {shown === null || result === undefined ? (
        error === null && <Loading size="xs" label="Reckoning the current" />
      ) : (
        <div className="fades" data-stale={stale} data-testid="drive-current">
          <Plot
            label="Coil current over the move"
            summary={`At rest after ${duration(result.motion_s)}; ${result.stretches.length} stretches of current`}
            series={[{ label: "coil current", unit, color, width: 2, fill: `${color}2a` }]}
            data={[...shown.current]}
            x={{ label: "time", unit: "s" }}
            scales={{ y: { unit, include: [0, unit === "%" ? 100 : (fullScale ?? 1)] } }}
            marks={[
              {
                id: "rest",
                x: result.motion_s,
                color: colorOf("position_reached", scheme),
                label: "at rest",
                fixed: true,
              },
            ]}
            group={`output-${of}`}
            height={190}
          />
          <Plot
            label="Velocity of the move"
            series={[{ label: "velocity", unit: "pps", color: colorOf("velocity", scheme), width: 2 }]}
            data={[...shown.velocity]}
            x={{ label: "time", unit: "s" }}
            scales={{ y: { unit: "pps", include: [0] } }}
            group={`output-${of}`}
            height={130}
          />
          <table className="figures">
            <thead>
              <tr>
                <th scope="col">What is asked for</th>
                <th scope="col">Scale</th>
                <th scope="col">From</th>
                <th scope="col">Until</th>
              </tr>
            </thead>
            <tbody>
              {rowsOf(result).map(({ situation, scale, fromS, untilS }) => (
                <tr key={`${situation}${fromS}`}>
                  <th scope="row">{situation}</th>
                  <td className="num">{scale}</td>
                  <td className="num">{duration(fromS)}</td>
                  <td className="num">{duration(untilS)}</td>
                </tr>
              ))}
            </tbody>
          </table>
          <Text className="hint">
            The coils get {fixed(result.mean_square * 100, 0, "%")} of full scale's heat in motion, and{" "}
            {fixed(result.rest_square * 100, 0, "%")} at rest.
          </Text>
          <WarningLines texts={result.findings} />
        </div>
      )}
    </Card>
  );
}
