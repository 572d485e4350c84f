import { Button, SegmentedControl, Text } from "@mantine/core";
import { useLocalStorage } from "@mantine/hooks";
import { api, type Schemas } from "../../../api/client";
import { Card } from "../../../lib/Card";
import { duration, fixed } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf } from "../../../lib/palette";
import { ChipField } from "../../../lib/rows/ChipField";
import { useCalc } from "../../../lib/useCalc";
import { useScheme } from "../../../lib/useScheme";
import { WarningLines } from "../../../lib/Warnings";
import type { Registers } from "./chip";
import classes from "./currents.module.css";
import { HoldPlot } from "./HoldPlot";
import type { Model } from "./models";
import { bodyOf, type CurrentBody, fieldsOf, type Sensing, wantedBody } from "./sensing";

type Result = Schemas["CoilCurrentResult"];

interface Props {
  chip: Registers;
  model: Model;
  clockHz: number;
  sensing: Sensing;
  onSensing: (part: Partial<Sensing>) => void;
  disabled: boolean;
}

/** The one calculator behind both ways. */
export const askCurrent = (body: CurrentBody, signal: AbortSignal): Promise<Result> =>
  api.POST("/api/v1/calc/coil-current", { body, signal });

/** What the current registers make of the coils, and what registers a current needs. */
export function CurrentSection({ chip, model, clockHz, sensing, onSensing, disabled }: Props) {
  const fields = fieldsOf(chip, model);
  const body = bodyOf(chip, model, clockHz, sensing);
  const { result, stale, error, retry } = useCalc("coil-current", body, askCurrent);
  const hold = result?.hold ?? null;
  const fieldOf = (register: string, field?: string, physical?: (value: number) => string) => (
    <ChipField
      chip={chip}
      register={register}
      disabled={disabled}
      physical={physical}
      {...(field === undefined ? {} : { field })}
    />
  );
  const share = (scale: number) => `${scale + 1}/32 of full scale`;
  return (
    <Card title="Coil current" note={result ? result.source : undefined}>
      {error !== null && <ProblemAlert error={error} doing="Reckoning the current" retry={retry} />}
      <div className="halves gap-8 my-8 fades" data-stale={stale} data-testid="amps">
        <Amps name="run" setting={result?.run ?? null} />
        <Amps name="hold" setting={hold} />
      </div>
      <div className={classes.fields}>
        {fieldOf("IHOLD_IRUN", "IRUN", share)}
        {fieldOf("IHOLD_IRUN", "IHOLD", share)}
        {fields.scaled && fieldOf("GLOBAL_SCALER", undefined, scalerText)}
        {fields.ranged && fieldOf("DRV_CONF", "CURRENT_RANGE")}
        {!fields.scaled && fieldOf("CHOPCONF", "vsense")}
        {fieldOf("IHOLD_IRUN", "IHOLDDELAY", (value) =>
          value === 0 ? "at once" : `${duration((value * 2 ** 18) / clockHz)} a step`,
        )}
        {fields.waits && fieldOf("TPOWERDOWN", undefined, (value) => duration((value * 2 ** 18) / clockHz))}
        {fields.internal || fields.ranged ? (
          <NumberField
            label="reference resistor"
            unit="Ω"
            value={sensing.referenceOhm}
            min={fields.ranged ? 12_000 : 100}
            max={fields.ranged ? 60_000 : 1e6}
            step={100}
            description={fields.ranged ? "IREF to ground" : "5VOUT to AIN_IREF"}
            inputWrapperOrder={ORDER}
            onChange={(referenceOhm) => onSensing({ referenceOhm })}
          />
        ) : (
          <NumberField
            label="sense resistor"
            unit="mΩ"
            value={sensing.senseOhm * 1000}
            min={1}
            max={10_000}
            step={5}
            description={
              result?.sense_power_w ? `gets ${fixed(result.sense_power_w * 1000)} mW at most` : "on the board"
            }
            inputWrapperOrder={ORDER}
            onChange={(mOhm) => onSensing({ senseOhm: mOhm / 1000 })}
            data-testid="sense-resistor"
          />
        )}
        {fields.analog && (
          <NumberField
            label="AIN_IREF"
            unit="V"
            value={sensing.ainV}
            min={0}
            max={5}
            step={0.1}
            description="2.5 V is full scale"
            inputWrapperOrder={ORDER}
            onChange={(ainV) => onSensing({ ainV })}
          />
        )}
      </div>
      {model === "tmc5130" && (
        <div className="lines-16 mt-8">
          <ChipField chip={chip} register="GCONF" field="internal_Rsense" disabled={disabled} />
          <ChipField chip={chip} register="GCONF" field="I_scale_analog" disabled={disabled} />
        </div>
      )}
      <WarningLines texts={result?.warnings ?? []} />
      {result && hold && (
        <>
          <HoldPlot
            delay={result.delay}
            irun={result.run.scale}
            ihold={hold.scale}
            fullScaleA={result.full_scale_rms_a}
          />
          <Text className="hint">{result.formula}</Text>
        </>
      )}
      {body && <Wanted chip={chip} body={body} result={result} disabled={disabled} />}
    </Card>
  );
}

const ORDER: ("label" | "input" | "description" | "error")[] = ["label", "input", "description", "error"];

function scalerText(value: number): string {
  if (value === 0) return "256/256: full scale";
  return value < 32 ? "not below 32" : `${value}/256`;
}

function Amps({ name, setting }: { name: "run" | "hold"; setting: Schemas["CurrentSetting"] | null }) {
  const scheme = useScheme();
  return (
    <div className="box pad" data-name={name}>
      <span className="row hint gap-6">
        <span className="swatch" style={{ background: colorOf("current_scale", scheme) }} />
        {name} current
      </span>
      <div className="tight" data-testid={`${name}-rms`}>
        <Text span fz={24} className="mono">
          {setting ? fixed(setting.rms_a, 3) : "–"}
        </Text>
        <span className="hint ml-4">A rms</span>
      </div>
      <div className="hint">
        <span className="num">{setting ? fixed(setting.peak_a, 3) : "–"}</span> A peak
      </div>
    </div>
  );
}

interface WantedProps {
  chip: Registers;
  body: CurrentBody;
  result: Result | undefined;
  disabled: boolean;
}

/** The other way: currents that are wanted, and the settings that come nearest. */
function Wanted({ chip, body, result, disabled }: WantedProps) {
  const [runA, setRunA] = useLocalStorage({ key: "stepscope.currents.run", defaultValue: 1 });
  const [holdA, setHoldA] = useLocalStorage({ key: "stepscope.currents.hold", defaultValue: 0.5 });
  const [measure, setMeasure] = useLocalStorage<"rms" | "peak">({
    key: "stepscope.currents.measure",
    defaultValue: "rms",
  });
  const found = useCalc("coil-current-wanted", wantedBody(body, runA, holdA, measure), askCurrent);
  const answer = found.result;
  const held =
    answer?.settings.every(({ name, field, value }) => chip.planned(name, field ?? undefined) === value) ?? false;
  const use = (settings: readonly Schemas["FieldSetting"][]) => {
    for (const { name, field, value } of settings) chip.put(name, field ?? undefined, value);
  };
  return (
    <div className="pt-8 grid gap-8 mt-12 rule-top">
      <div className="row wrap between gap-8">
        <Text component="h3" size="sm" fw={600}>
          From a wanted current
        </Text>
        <SegmentedControl
          aria-label="Currents as"
          data={["rms", "peak"]}
          value={measure}
          onChange={(value) => setMeasure(value as "rms" | "peak")}
        />
      </div>
      <div className="flex end gap-8">
        <NumberField
          label="Run"
          unit={`A ${measure}`}
          value={runA}
          min={0.001}
          max={100}
          step={0.05}
          onChange={setRunA}
          data-testid="wanted-run"
        />
        <NumberField
          label="Hold"
          unit={`A ${measure}`}
          value={holdA}
          min={0}
          max={100}
          step={0.05}
          onChange={setHoldA}
          data-testid="wanted-hold"
        />
        <Button
          disabled={disabled || answer === undefined || found.stale || held}
          onClick={() => answer && use(answer.settings)}
          title="Stages these values; Apply below writes them"
          data-testid="use-wanted"
        >
          {held ? "is set" : "Use"}
        </Button>
      </div>
      {found.error !== null && <ProblemAlert error={found.error} doing="Looking for settings" retry={found.retry} />}
      {answer && (
        <>
          <div className="scroll-x">
            <table className="figures" data-testid="nearest">
              <thead>
                <tr>
                  <th scope="col">IRUN</th>
                  <th scope="col">{answer.run.global_scaler === null ? "vsense" : "GLOBAL_SCALER"}</th>
                  <th scope="col">A rms</th>
                  <th scope="col">A peak</th>
                  <th scope="col">off by</th>
                </tr>
              </thead>
              <tbody>
                {answer.nearest.slice(0, 4).map((setting, row) => (
                  <tr key={`${setting.scale} ${setting.vsense} ${setting.global_scaler}`} data-best={row === 0}>
                    <th scope="row" className="num">
                      {setting.scale}
                    </th>
                    <td className="num">{setting.vsense ?? setting.global_scaler}</td>
                    <td className="num">{fixed(setting.rms_a, 3)}</td>
                    <td className="num">{fixed(setting.peak_a, 3)}</td>
                    <td className="num">{percent(setting.error)}</td>
                  </tr>
                ))}
              </tbody>
            </table>
          </div>
          {answer.hold && (
            <Text className="hint">
              IHOLD {answer.hold.scale}: {fixed(answer.hold.rms_a, 3, "A")} rms at rest, {percent(answer.hold.error)}{" "}
              off.
            </Text>
          )}
          <WarningLines texts={answer.warnings.filter((warning) => !result?.warnings.includes(warning))} />
        </>
      )}
    </div>
  );
}

function percent(error: number | null): string {
  return error === null ? "–" : fixed(error * 100, 2, "%");
}
