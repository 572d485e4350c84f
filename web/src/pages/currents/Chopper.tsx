import { Badge, Button, Text } from "@mantine/core";
import { useLocalStorage } from "@mantine/hooks";
import { api, type Schemas, unwrap } from "../../api/client";
import { compact, fixed, frequency, withUnit } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { Section } from "../../lib/Section";
import { useCalc } from "../../lib/useCalc";
import type { Registers } from "./chip";
import classes from "./currents.module.css";
import type { Model } from "./models";
import type { SpeedScale } from "./speed";

type Result = Schemas["ChopperResult"];
type Setting = Schemas["ChopperSetting"];

interface Motor {
  ohm: number;
  mH: number;
  supplyV: number;
  holdingNm: number;
  ratedA: number;
  chopperKhz: number;
}

/** A common 40 mm motor, as on the ramp pages. */
const MOTOR: Motor = { ohm: 2.3, mH: 4.4, supplyV: 24, holdingNm: 0.45, ratedA: 1.5, chopperKhz: 25 };
const FIELDS: readonly { key: keyof Motor; label: string; unit: string; least: number; most: number; title: string }[] =
  [
    { key: "ohm", label: "resistance", unit: "Ω", least: 0.01, most: 1000, title: "of a coil" },
    { key: "mH", label: "inductance", unit: "mH", least: 0.01, most: 5000, title: "of a coil" },
    { key: "supplyV", label: "supply", unit: "V", least: 1, most: 100, title: "of the motor" },
    { key: "ratedA", label: "rated current", unit: "A", least: 0.01, most: 50, title: "at which the torque is meant" },
    {
      key: "holdingNm",
      label: "holding torque",
      unit: "Nm",
      least: 0.001,
      most: 500,
      title: "both coils at that current",
    },
    { key: "chopperKhz", label: "chopper", unit: "kHz", least: 5, most: 200, title: "wanted frequency of SpreadCycle" },
  ];

interface Props {
  chip: Registers;
  model: Model;
  scale: SpeedScale;
  /** of the run current as it is set [A]; null while unknown */
  runRmsA: number | null;
  disabled: boolean;
}

/** Where to begin with the chopper, from what the motor's data sheet says, each with its reason. */
export function Chopper({ chip, model, scale, runRmsA, disabled }: Props) {
  const [motor, setMotor] = useLocalStorage<Motor>({
    key: "stepscope.currents.motor",
    defaultValue: MOTOR,
    getInitialValueInEffect: false,
  });
  const irun = chip.planned("IHOLD_IRUN", "IRUN");
  const body: Schemas["Chopper"] | null =
    runRmsA === null || irun === null
      ? null
      : {
          model,
          clock_hz: scale.clockHz,
          resistance_ohm: motor.ohm,
          inductance_h: motor.mH / 1000,
          current_a: runRmsA,
          supply_v: motor.supplyV,
          holding_torque_nm: motor.holdingNm,
          rated_current_a: motor.ratedA,
          full_steps_per_rev: scale.fullStepsPerTurn,
          microsteps_per_full_step: scale.microsteps as NonNullable<Schemas["Chopper"]["microsteps_per_full_step"]>,
          irun,
          chopper_hz: motor.chopperKhz * 1000,
        };
  const { result, stale, error, retry } = useCalc<Schemas["Chopper"], Result>("chopper", body, async (asked, signal) =>
    unwrap(await api.POST("/api/v1/calc/chopper", { body: asked, signal })),
  );
  const differs = (setting: Setting) => chip.planned(setting.name, setting.field) !== setting.value;
  const left = (result?.settings ?? []).filter(differs);
  const put = (settings: readonly Setting[]) => {
    for (const { name, field, value } of settings) chip.put(name, field, value);
  };
  return (
    <Section
      title="Chopper to begin with"
      note={runRmsA === null ? undefined : `for ${fixed(runRmsA, 2)} A rms`}
      actions={
        <Button
          size="compact-xs"
          disabled={disabled || stale || left.length === 0}
          onClick={() => put(left)}
          data-testid="use-chopper"
        >
          {left.length === 0 ? "all set" : `Use all ${left.length}`}
        </Button>
      }
    >
      <div className={classes.fields}>
        {FIELDS.map(({ key, label, unit, least, most, title }) => (
          <NumberField
            key={key}
            label={label}
            title={title}
            unit={unit}
            value={motor[key]}
            min={least}
            max={most}
            step={motor[key] / 20}
            onChange={(value) => setMotor({ ...motor, [key]: value })}
            data-testid={`motor-${key}`}
          />
        ))}
      </div>
      {error !== null && <ProblemAlert error={error} doing="Looking for a chopper" retry={retry} />}
      {result && (
        <div data-stale={stale} className={classes.hints}>
          <ul className={classes.hintList} aria-label="Settings">
            {result.settings.map((setting) => (
              <li
                key={`${setting.name}.${setting.field}`}
                className={classes.setting}
                data-testid={`hint-${setting.field}`}
              >
                <span className={classes.settingName}>
                  <span className="num">{setting.field}</span>
                  <span className={classes.settingValue}>{setting.value}</span>
                </span>
                <span className={classes.settingText}>
                  <b>{setting.meaning}</b>
                  <span>{setting.reason}</span>
                  <cite>{setting.source}</cite>
                </span>
                <Held chip={chip} setting={setting} disabled={disabled} onUse={() => put([setting])} />
              </li>
            ))}
          </ul>
          <table className={`words-figures ${classes.follows}`}>
            <thead>
              <tr>
                <th scope="col">What follows</th>
                <th scope="col"> </th>
              </tr>
            </thead>
            <tbody>
              {result.figures.map((figure) => (
                <tr
                  key={figure.name}
                  title={`${figure.reason} (${figure.source})`}
                  data-testid={`figure-${figure.name}`}
                >
                  <th scope="row">{figure.label}</th>
                  <td className="num">{figureText(figure)}</td>
                </tr>
              ))}
            </tbody>
          </table>
          {result.warnings.map((warning) => (
            <Text key={warning} className={classes.caution} role="status">
              {warning}
            </Text>
          ))}
        </div>
      )}
      {body === null && <Text className={classes.hint}>Waits for the run current: IRUN is not known yet.</Text>}
    </Section>
  );
}

function Held(props: { chip: Registers; setting: Setting; disabled: boolean; onUse: () => void }) {
  const { chip, setting, disabled, onUse } = props;
  const planned = chip.planned(setting.name, setting.field);
  if (planned === setting.value)
    return (
      <Badge size="sm" variant="light" className={classes.held}>
        {chip.isStaged(setting.name, setting.field) ? "staged" : "is set"}
      </Badge>
    );
  return (
    <Button
      size="compact-xs"
      variant="default"
      disabled={disabled}
      aria-label={`Use ${setting.field} ${setting.value}`}
      onClick={onUse}
    >
      {planned === null ? "use" : `${planned} → ${setting.value}`}
    </Button>
  );
}

function figureText({ value, unit }: Schemas["ChopperFigure"]): string {
  if (unit === "Hz") return frequency(value);
  return unit === "pps" ? `${compact(Math.round(value))} pps` : withUnit(value, unit, 3);
}
