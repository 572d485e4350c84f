import { useState } from "react";
import css from "./connections.module.css";
import { AXIS_LIMITS, type AxisDraft, type Draft } from "./draft";
import { OptionalNumber } from "./fields";

interface Props {
  draft: Draft;
  problems: Readonly<Record<string, string>>;
  onChange: (axes: AxisDraft[]) => void;
}

const PARTS = [
  { part: "lostSteps", label: "Lost steps from", placeholder: "two full steps" },
  { part: "followingError", label: "Following error from", placeholder: "four full steps" },
] as const;

/** From which deviation of the encoder on an axis has lost steps, or does not follow. */
export function ThresholdFields({ draft, problems, onChange }: Props) {
  const rows = draft.axes.map((axis, index) => ({ axis, index }));
  const any = draft.axes.some((axis) => PARTS.some(({ part }) => axis[part] !== ""));
  const [open, setOpen] = useState(any);
  const wrong = rows.some(({ index }) => PARTS.some(({ part }) => problems[`axes.${index}.${part}`]));
  return (
    <details
      className={`${css.limits} pad-s box mt-8`}
      open={open || wrong}
      onToggle={(event) => setOpen(event.currentTarget.open)}
    >
      <summary>
        Encoder thresholds
        <span className={`${css.limitNote} hint regular`}>
          from where on steps are lost, or a motion is not followed
        </span>
      </summary>
      {rows.map(({ axis, index }) => (
        <fieldset key={index} className={css.limitAxis}>
          <legend>{axis.name || `axis ${index}`}</legend>
          <div className={css.limitGrid}>
            {PARTS.map(({ part, label, placeholder }) => (
              <OptionalNumber
                key={part}
                label={label}
                unit="µsteps"
                placeholder={placeholder}
                value={axis[part]}
                limits={AXIS_LIMITS[part]}
                problem={problems[`axes.${index}.${part}`]}
                onChange={(text) =>
                  onChange(draft.axes.map((each, at) => (at === index ? { ...each, [part]: text } : each)))
                }
              />
            ))}
          </div>
        </fieldset>
      ))}
    </details>
  );
}
