import { Button, Checkbox, Group, Text } from "@mantine/core";
import { type FormEvent, useState } from "react";
import type { Schemas } from "../../api/client";
import { ProblemAlert } from "../ProblemAlert";
import { changesOf, type MeasuredFigure } from "./changes";
import { draftOf, figuresOf } from "./figures";
import { useKeepMotor } from "./useOwnMotors";

interface Props {
  motor: Schemas["MotorInfo"];
  measured: readonly MeasuredFigure[];
  /** it is changed, or left as it was */
  onEnd: (changed: boolean) => void;
}

/** Figures of a motor of one's own as they are kept and as they were measured, and which of them to take. */
export function ChangeForm({ motor, measured, onEnd }: Props) {
  const changes = changesOf(motor, measured);
  const [taken, setTaken] = useState(() => changes.filter(({ doubt }) => doubt === "").map(({ key }) => key));
  const keep = useKeepMotor();
  const save = (event: FormEvent<HTMLFormElement>) => {
    event.preventDefault();
    const figures = figuresOf(draftOf(motor));
    if (figures === null) return;
    for (const { key, after } of changes) if (taken.includes(key)) figures[key] = after;
    keep.mutate({ name: motor.name, figures }, { onSuccess: () => onEnd(true) });
  };
  return (
    <form aria-label={`Change ${motor.name}`} className="column" onSubmit={save}>
      <b className="text-14 anywhere">{motor.name}</b>
      {changes.length === 0 && <Text size="sm">It has the figures that were measured.</Text>}
      {changes.map(({ key, text, doubt }, index) => (
        <Checkbox
          key={key}
          ref={index === 0 ? atOnce : undefined}
          label={text}
          description={doubt}
          checked={taken.includes(key)}
          onChange={({ currentTarget: { checked } }) =>
            setTaken((now) => [...now.filter((each) => each !== key), ...(checked ? [key] : [])])
          }
        />
      ))}
      <ProblemAlert error={keep.error} doing="Changing the motor" onClose={() => keep.reset()} />
      <Group gap="xs">
        <Button type="submit" loading={keep.isPending} disabled={taken.length === 0}>
          Change it
        </Button>
        <Button ref={changes.length === 0 ? atOnce : undefined} variant="default" onClick={() => onEnd(false)}>
          Cancel
        </Button>
      </Group>
    </form>
  );
}

const atOnce = (first: HTMLElement | null) => first?.focus();
