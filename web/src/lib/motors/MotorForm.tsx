import { Button, Group, Text, TextInput } from "@mantine/core";
import { type FormEvent, useState } from "react";
import { NumberField } from "../NumberField";
import { ProblemAlert } from "../ProblemAlert";
import { FurtherFields } from "./FurtherFields";
import { figuresOf, type MotorDraft, nameProblem } from "./figures";
import classes from "./motors.module.css";
import { useKeepMotor } from "./useOwnMotors";
import { useRefused } from "./useRefused";

interface Props {
  start: MotorDraft;
  /** the name of the motor that is edited; null: a new one */
  edited: string | null;
  /** names of one's other motors */
  taken: readonly string[];
  /** it is kept, or left as it was */
  onEnd: () => void;
}

/** A motor of one's own as its plate and data sheet name it. */
export function MotorForm({ start, edited, taken, onEnd }: Props) {
  const [motor, setMotor] = useState(start);
  const [asked, setAsked] = useState(false);
  const refused = useRefused();
  const keep = useKeepMotor();
  const set = (change: Partial<MotorDraft>) => setMotor((now) => ({ ...now, ...change }));
  const name = motor.name.trim();
  const wrongName = nameProblem(name, taken);
  const save = (event: FormEvent<HTMLFormElement>) => {
    event.preventDefault();
    setAsked(true);
    const figures = figuresOf(motor);
    if (wrongName === undefined && figures !== null && !refused.any)
      keep.mutate({ name, figures, instead: edited }, { onSuccess: onEnd });
  };
  return (
    <form aria-label={edited ?? "A new motor"} className="column" onSubmit={save}>
      <TextInput
        label="Name"
        description="as its plate has it"
        data-autofocus
        ref={atOnce}
        maxLength={80}
        value={motor.name}
        error={asked ? wrongName : undefined}
        onChange={({ currentTarget }) => set({ name: currentTarget.value })}
      />
      <div className={classes.fields}>
        <NumberField
          label="Rated current"
          unit="A"
          min={0.01}
          max={100}
          step={0.1}
          value={motor.rated_current_a}
          error={asked && motor.rated_current_a === null ? "The rated current is needed" : undefined}
          onChange={(rated_current_a) => set({ rated_current_a })}
          onClear={() => set({ rated_current_a: null })}
          onWrong={refused.onWrong("rated_current_a")}
        />
        <NumberField
          label="Full steps a turn"
          integer
          min={1}
          max={100_000}
          value={motor.full_steps_per_rev}
          onChange={(full_steps_per_rev) => set({ full_steps_per_rev })}
          onWrong={refused.onWrong("full_steps_per_rev")}
        />
        <FurtherFields figures={motor} set={set} onWrong={refused.onWrong} />
      </div>
      <Text size="sm" className="dim">
        Name and rated current are needed. What the data sheet does not tell stays empty: nothing is reckoned with it.
      </Text>
      <ProblemAlert error={keep.error} doing="Keeping the motor" onClose={() => keep.reset()} />
      <Group gap="xs">
        <Button type="submit" loading={keep.isPending} disabled={refused.any}>
          Keep it
        </Button>
        <Button variant="default" onClick={onEnd}>
          Cancel
        </Button>
      </Group>
    </form>
  );
}

const atOnce = (field: HTMLInputElement | null) => field?.focus();
