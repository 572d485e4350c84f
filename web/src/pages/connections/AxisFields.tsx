import { TextInput } from "@mantine/core";
import { CHIP_LIMITS } from "./chip";
import css from "./connections.module.css";
import { AXIS_LIMITS, type AxisDraft, type Draft, type StageDraft } from "./draft";
import { OptionalNumber } from "./fields";
import { canModel } from "./models";

interface AxesProps {
  draft: Draft;
  problems: Readonly<Record<string, string>>;
  /** say of empty fields, too, that they are wanted */
  strict: boolean;
  onChange: (axes: AxisDraft[]) => void;
}

/** The motor on each axis and what it moves. */
export function AxesFields({ draft, problems, strict, onChange }: AxesProps) {
  const stepDir = canModel(draft.model, "step_dir");
  const set = (index: number, change: Partial<AxisDraft>) =>
    onChange(draft.axes.map((axis, at) => (at === index ? { ...axis, ...change } : axis)));
  const of = (index: number, part: AxisText) => {
    const text = draft.axes[index]?.[part] ?? "";
    return strict || text !== "" ? problems[`axes.${index}.${part}`] : undefined;
  };
  const rows = draft.axes.map((axis, index) => ({ axis, index }));
  return (
    <fieldset className={`${css.group} stack gap-8 m-0 mt-12 rule-top`}>
      <legend>Axes and what they move</legend>
      <div className={css.axisGrid} data-columns={stepDir ? 5 : 4}>
        <span>Name</span>
        <span>Full steps/rev</span>
        {stepDir && <span>Driver µsteps</span>}
        <span>Gear : 1</span>
        <span>Travel mm/rev</span>
        {rows.map(({ axis, index }) => {
          const label = (what: string) => `${what} of axis ${index}`;
          return (
            <div key={index} className="contents">
              <TextInput
                size="xs"
                aria-label={label("Name")}
                value={axis.name}
                error={of(index, "name") !== undefined}
                autoComplete="off"
                onChange={(event) => set(index, { name: event.currentTarget.value })}
              />
              <OptionalNumber
                cell
                label={label("Full steps per revolution")}
                value={axis.fullSteps}
                limits={AXIS_LIMITS.fullSteps}
                problem={of(index, "fullSteps")}
                onChange={(fullSteps) => set(index, { fullSteps })}
              />
              {stepDir && (
                <OptionalNumber
                  cell
                  label={label("Driver microsteps per full step")}
                  value={axis.driverMicrosteps}
                  limits={AXIS_LIMITS.driverMicrosteps}
                  problem={of(index, "driverMicrosteps")}
                  onChange={(driverMicrosteps) => set(index, { driverMicrosteps })}
                />
              )}
              <OptionalNumber
                cell
                label={label("Motor turns per turn of the load")}
                value={axis.gear}
                limits={AXIS_LIMITS.gear}
                problem={of(index, "gear")}
                onChange={(gear) => set(index, { gear })}
              />
              <OptionalNumber
                cell
                label={label("Travel per revolution")}
                unit="mm"
                placeholder="rotary"
                value={axis.travelMm}
                limits={AXIS_LIMITS.travelMm}
                problem={of(index, "travelMm")}
                onChange={(travelMm) => set(index, { travelMm })}
              />
            </div>
          );
        })}
      </div>
      <Problems
        lines={rows.flatMap(({ axis, index }) =>
          AXIS_PARTS.flatMap(([part, word]) => {
            const problem = of(index, part);
            return problem === undefined ? [] : [`${axis.name || `axis ${index}`}, ${word}: ${problem}`];
          }),
        )}
      />
    </fieldset>
  );
}

/** What is typed of an axis itself. */
type AxisText = Exclude<keyof AxisDraft, "limits">;

const AXIS_PARTS: [AxisText, string][] = [
  ["name", "name"],
  ["fullSteps", "full steps"],
  ["driverMicrosteps", "driver microsteps"],
  ["gear", "gear"],
  ["travelMm", "travel"],
];

interface StageProps {
  draft: Draft;
  problems: Readonly<Record<string, string>>;
  onChange: (stages: StageDraft[]) => void;
}

const STAGE_PARTS: [part: keyof StageDraft, heading: string, word: string][] = [
  ["left", "Left", "left switch"],
  ["refFrom", "Ref. from", "left end of the reference switch"],
  ["refTo", "Ref. to", "right end of the reference switch"],
  ["right", "Right", "right switch"],
  ["start", "Start", "carriage at first"],
];

/** Where the switches of each emulated stage are. */
export function StageFields({ draft, problems, onChange }: StageProps) {
  const set = (index: number, change: Partial<StageDraft>) =>
    onChange(draft.stages.map((stage, at) => (at === index ? { ...stage, ...change } : stage)));
  const rows = draft.stages.map((stage, index) => ({ stage, index, name: draft.axes[index]?.name || `axis ${index}` }));
  return (
    <div>
      <div className="hint mb-4">Stages: switches and carriage, in full steps of the motor</div>
      <div className={css.stageGrid}>
        <span>Axis</span>
        {STAGE_PARTS.map(([part, heading]) => (
          <span key={part}>{heading}</span>
        ))}
        {rows.map(({ stage, index, name }) => (
          <div key={index} className="contents">
            <span className={css.stageName}>{name}</span>
            {STAGE_PARTS.map(([part, , word]) => (
              <OptionalNumber
                key={part}
                cell
                label={`${name}, ${word}`}
                unit="full steps"
                value={stage[part]}
                limits={CHIP_LIMITS[part]}
                problem={problems[`stages.${index}.${part}`]}
                onChange={(text) => set(index, { [part]: text })}
              />
            ))}
          </div>
        ))}
      </div>
      <Problems
        lines={rows.flatMap(({ index, name }) =>
          STAGE_PARTS.flatMap(([part, , word]) => {
            const problem = problems[`stages.${index}.${part}`];
            return problem === undefined ? [] : [`${name}, ${word}: ${problem}`];
          }),
        )}
      />
    </div>
  );
}

function Problems({ lines }: { lines: string[] }) {
  if (lines.length === 0) return null;
  return (
    <div className="m-0 mt-4 fault text-12" role="alert">
      {lines.map((line) => (
        <div key={line}>{line}</div>
      ))}
    </div>
  );
}
