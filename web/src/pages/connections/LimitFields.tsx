import { useState } from "react";
import type { AxisScale } from "../../lib/units";
import css from "./connections.module.css";
import type { AxisDraft, Draft } from "./draft";
import { OptionalNumber } from "./fields";
import { inMechanics, limited, partsOf } from "./softLimits";

interface Props {
  draft: Draft;
  problems: Readonly<Record<string, string>>;
  /** by axis: what its microsteps are in millimetres or degrees, as far as that is known */
  scales: readonly (AxisScale | undefined)[];
  onChange: (axes: AxisDraft[]) => void;
}

/** What each axis may be asked for at most: the server refuses the rest, whoever asks. */
export function LimitFields({ draft, problems, scales, onChange }: Props) {
  const parts = partsOf(draft.model);
  const rows = draft.axes.map((axis, index) => ({ axis, index }));
  const any = draft.axes.some((axis) => limited(axis.limits));
  const [open, setOpen] = useState(any);
  const set = (index: number, change: Partial<AxisDraft["limits"]>) =>
    onChange(draft.axes.map((axis, at) => (at === index ? { ...axis, limits: { ...axis.limits, ...change } } : axis)));
  const wrong = draft.axes.some((_, index) => parts.some(({ part }) => problems[`axes.${index}.limits.${part}`]));
  return (
    <details
      className={`${css.limits} pad-s box mt-8`}
      open={open || wrong}
      onToggle={(event) => setOpen(event.currentTarget.open)}
    >
      <summary>
        Soft limits
        <span className={`${css.limitNote} hint regular`}>
          {any
            ? "the server refuses what is beyond, and stops an axis at its ends"
            : "none: an empty field limits nothing"}
        </span>
      </summary>
      {rows.map(({ axis, index }) => {
        const name = axis.name || `axis ${index}`;
        const own = inMechanics(axis.limits, scales[index]);
        return (
          <fieldset key={index} className={css.limitAxis}>
            <legend>{name}</legend>
            <div className={css.limitGrid}>
              {parts.map(({ part, label, unit, limits }) => (
                <OptionalNumber
                  key={part}
                  label={label}
                  unit={unit}
                  placeholder={part === "senseOhm" || part === "fullScaleA" ? "" : "no limit"}
                  value={axis.limits[part]}
                  limits={limits}
                  problem={problems[`axes.${index}.limits.${part}`]}
                  onChange={(text) => set(index, { [part]: text })}
                />
              ))}
            </div>
            {own !== "" && <div className={`${css.limitNote} hint regular`}>{own}</div>}
          </fieldset>
        );
      })}
    </details>
  );
}
