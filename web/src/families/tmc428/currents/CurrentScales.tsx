import { Text } from "@mantine/core";
import { useMemo, useState } from "react";
import { api, type Schemas } from "../../../api/client";
import type { Device } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { duration, fixed } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf } from "../../../lib/palette";
import { StagedDrawer } from "../../../lib/rows/StagedDrawer";
import { useChipRows } from "../../../lib/rows/useChipRows";
import { useCalc } from "../../../lib/useCalc";
import { useScheme } from "../../../lib/useScheme";
import { WarningList } from "../../../lib/Warnings";
import { Plot } from "../../../plots/Plot";
import {
  AFTER_POWER_ON,
  type Codes,
  codeOf,
  currentLine,
  effectiveMicrosteps,
  eighthsOf,
  SCALES,
  type ScaleField,
} from "./line";

const REGISTER = "is_agtat_is_aleat_is_v0_a_threshold";
const GLOBAL = "stepper_motor_global_parameter_register";
const GROUPS = ["current", "global"] as const;

interface Props {
  device: Device | undefined;
  axis: number;
  /** the planned ramp, as POST /calc/ramp takes it; null while it is not known */
  ramp: { parameters: Record<string, number | string>; distance: number } | null;
  usrs: number;
}

/** What the coils get while the motor rests, moves and accelerates, over the ramp that is planned above. */
export function CurrentScales({ device, axis, ramp, usrs }: Props) {
  const chip = useChipRows(device, axis, GROUPS);
  const scheme = useScheme();
  const [own, setOwn] = useState<Codes>(AFTER_POWER_ON);
  const known = chip.spot(REGISTER) !== null;
  const unread = device !== undefined && (known ? chip.origin(REGISTER) === "unknown" : !chip.known);
  const read = (field: keyof Codes) => (known ? (chip.planned(REGISTER, field) ?? 0) : own[field]);
  const codes: Codes = {
    is_agtat: read("is_agtat"),
    is_aleat: read("is_aleat"),
    is_v0: read("is_v0"),
    a_threshold: read("a_threshold"),
  };
  const put = (field: keyof Codes, value: number) =>
    known ? chip.put(REGISTER, field, value) : setOwn((now) => ({ ...now, [field]: value }));
  const updates = chip.planned(GLOBAL, "continuous_update");
  const fullScaleA = device?.axes[axis]?.limits.current_full_scale_a ?? null;

  const found = useCalc<Schemas["CurrentScaling"], Schemas["CurrentScalingResult"]>(
    "current-scales",
    ramp === null || unread ? null : { ...ramp, ...codes, continuous_update: updates === null ? null : updates === 1 },
    (body, signal) => api.POST("/api/v1/calc/current-scales", { body, signal }),
  );
  const { result, stale } = found;
  const line = useMemo(() => (result ? currentLine(result.spans, fullScaleA) : null), [result, fullScaleA]);
  const color = colorOf("current_scale", scheme);
  const unit = fullScaleA === null ? "%" : "A";

  return (
    <Card
      title="Coil current over the ramp"
      note={
        result ? (
          <span className={stale ? "stale" : undefined}>
            heat in the coils {fixed(result.heat * 100, 0, "%")} of full scale's, at rest after{" "}
            {duration(result.rest_delay_s)}
          </span>
        ) : (
          ""
        )
      }
    >
      <div className="lines-16 start" data-testid="current-scales">
        {SCALES.map(({ field, title, note }) => (
          <Scale
            key={field}
            field={field}
            title={title}
            note={note}
            code={unread ? null : codes[field]}
            staged={known && chip.isStaged(REGISTER, field)}
            fullScaleA={fullScaleA}
            usrs={usrs}
            onChange={(code) => put(field, code)}
          />
        ))}
        <NumberField
          label="a_threshold"
          integer
          min={0}
          max={2047}
          step={10}
          value={unread ? null : codes.a_threshold}
          disabled={unread}
          description={known && chip.isStaged(REGISTER, "a_threshold") ? "not applied" : "unit of a_max"}
          inputWrapperOrder={["label", "input", "description", "error"]}
          onChange={(value) => put("a_threshold", value)}
          w={120}
          data-testid="field-a_threshold"
        />
      </div>
      {found.error !== null && (
        <ProblemAlert error={found.error} doing="Calculating the currents" retry={found.retry} />
      )}
      {line && (
        <div className={stale ? "stale" : undefined} aria-busy={stale}>
          <Plot
            label="Coil current over the ramp"
            summary={SCALES.map(({ field, title }) => `${title} ${fixed(eighthsOf(codes[field]) * 12.5, 1, "%")}`).join(
              ", ",
            )}
            series={[{ label: "coil current", unit, color, width: 2, fill: `${color}2a` }]}
            data={[line.x, line.y]}
            x={{ label: "time from the start of the move", unit: "s" }}
            scales={{ y: { unit, include: [0, fullScaleA ?? 100] } }}
            height={170}
          />
        </div>
      )}
      {result && (
        <Text className="hint" data-testid="scale-times">
          accelerating {duration(result.time_s.is_agtat ?? 0)} · moving and settling{" "}
          {duration(result.time_s.is_aleat ?? 0)}
          {result.braking_below === null || codes.is_agtat === codes.is_aleat
            ? ""
            : ` · ${fixed(result.braking_below * 100, 0, "%")} of braking at is_aleat: between two steps of v_target nothing accelerates`}
        </Text>
      )}
      <WarningList texts={result?.warnings ?? []} />
      {known && device && <StagedDrawer chip={chip} device={device} />}
    </Card>
  );
}

interface ScaleProps {
  field: ScaleField;
  title: string;
  note: string;
  /** null while the chip has not been read: what is typed then would be lost */
  code: number | null;
  staged: boolean;
  fullScaleA: number | null;
  usrs: number;
  onChange: (code: number) => void;
}

/** One scale, in eighths: an arrow key is one of them. */
function Scale({ field, title, note, code, staged, fullScaleA, usrs, onChange }: ScaleProps) {
  const eighths = code === null ? null : eighthsOf(code);
  const ampere = (share: number) => (fullScaleA === null ? "" : `${fixed((fullScaleA * share) / 8, 3, "A")}, `);
  return (
    <NumberField
      label={`${title} · ${field}`}
      title={note}
      unit="/ 8"
      integer
      min={1}
      max={8}
      value={eighths}
      disabled={eighths === null}
      description={
        eighths === null
          ? "not read yet"
          : staged
            ? "not applied"
            : `${fixed(eighths * 12.5, 1, "%")}, ${ampere(eighths)}${fixed(effectiveMicrosteps(usrs, eighths), 1)} µsteps`
      }
      inputWrapperOrder={["label", "input", "description", "error"]}
      onChange={(value) => onChange(codeOf(value))}
      w={190}
      data-testid={`field-${field}`}
    />
  );
}
