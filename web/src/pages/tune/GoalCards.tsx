import { useId } from "react";
import { sketchOf } from "./sketches";
import classes from "./tune.module.css";

interface Props<K extends string> {
  label: string;
  goals: readonly { value: K; label: string }[];
  value: K;
  onChange: (picked: K) => void;
}

/** One of several goals, each a card with a sketch; radio buttons to keys and to those who do not see them. */
export function GoalCards<K extends string>({ label, goals, value, onChange }: Props<K>) {
  const name = useId();
  return (
    <fieldset className="bare">
      <legend className="text-14 mb-4">{label}</legend>
      <div className={classes.goals}>
        {goals.map((goal) => (
          <label key={goal.value} className={classes.goal}>
            <input
              type="radio"
              className={classes.radio}
              name={name}
              value={goal.value}
              checked={goal.value === value}
              onChange={() => onChange(goal.value)}
            />
            {sketchOf(goal.value)}
            <span>{goal.label}</span>
          </label>
        ))}
      </div>
    </fieldset>
  );
}
