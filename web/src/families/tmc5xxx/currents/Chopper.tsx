import { Badge, Button, Text } from "@mantine/core";
import type { Schemas } from "../../../api/client";
import { Card } from "../../../lib/Card";
import { fixed } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { WarningLines } from "../../../lib/Warnings";
import type { Registers } from "./chip";
import classes from "./currents.module.css";
import type { ChopperQuestion, Motor } from "./useChopper";

type Setting = Schemas["ChopperSetting"];

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
  chopper: ChopperQuestion;
  disabled: boolean;
}

/** Where to begin with the chopper, from what the motor's data sheet says, each with its reason. */
export function Chopper({ chip, chopper, disabled }: Props) {
  const { motor, setMotor, runRmsA, answer } = chopper;
  const { result, stale, error, retry } = answer;
  const differs = (setting: Setting) => chip.planned(setting.name, setting.field) !== setting.value;
  // a module has parameters for most of them
  const settings = (result?.settings ?? []).filter(({ name, field }) => disabled || chip.spot(name, field) !== null);
  const left = settings.filter(differs);
  const put = (settings: readonly Setting[]) => {
    for (const { name, field, value } of settings) chip.put(name, field, value);
  };
  return (
    <Card
      title="Chopper to begin with"
      note={runRmsA === null ? undefined : `for ${fixed(runRmsA, 2, "A")} rms`}
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
            onChange={(value) => setMotor({ [key]: value })}
            data-testid={`motor-${key}`}
          />
        ))}
      </div>
      {error !== null && <ProblemAlert error={error} doing="Looking for a chopper" retry={retry} />}
      {result && (
        <div data-stale={stale} className="grid gap-8 mt-8 fades">
          <ul className="list" aria-label="Settings">
            {settings.map((setting) => (
              <li
                key={`${setting.name}.${setting.field}`}
                className={`${classes.setting} grid rule-top mid`}
                data-testid={`hint-${setting.field}`}
              >
                <span className="hint grid">
                  <span className="num">{setting.field}</span>
                  <span className="ink text-20 mono tight">{setting.value}</span>
                </span>
                <span className="grid text-12 tight dim">
                  <b className="ink bold">{setting.meaning}</b>
                  <span>{setting.reason}</span>
                  <cite>{setting.source}</cite>
                </span>
                <Held chip={chip} setting={setting} disabled={disabled} onUse={() => put([setting])} />
              </li>
            ))}
          </ul>
          <WarningLines texts={result.warnings} />
        </div>
      )}
      {runRmsA === null && <Text className="hint">Waits for the run current: IRUN is not known yet.</Text>}
    </Card>
  );
}

function Held(props: { chip: Registers; setting: Setting; disabled: boolean; onUse: () => void }) {
  const { chip, setting, disabled, onUse } = props;
  const planned = chip.planned(setting.name, setting.field);
  if (planned === setting.value)
    return (
      <Badge size="sm" variant="light">
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
