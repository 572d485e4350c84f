import { ActionIcon, Button, Group, Select, Text, TextInput } from "@mantine/core";
import { IconArrowDown, IconArrowUp, IconTrash } from "@tabler/icons-react";
import { useState } from "react";
import { fieldsOf, KINDS, moved, type Step, type StepField, shown, written } from "./macroSteps";

const TITLES = Object.entries(KINDS).map(([value, { title }]) => ({ value, label: title }));

interface Props {
  steps: readonly Step[];
  onChange: (steps: Step[]) => void;
}

/** The steps of a macro as a form: each with its fields, to be ordered and deleted, and one to be added behind them. */
export function MacroSteps({ steps, onChange }: Props) {
  return (
    <div className="stack gap-6">
      {steps.length === 0 && <Text size="sm">It has no step yet.</Text>}
      <ol className="list stack gap-8">
        {steps.map((step, index) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: two steps may say the same; the place is what tells them apart
          <li key={`${index}/${step.do}`}>
            <fieldset className="bare row wrap gap-6" aria-label={`Step ${index + 1}`}>
              <div className="row gap-6 w-full">
                <Select
                  size="xs"
                  w={170}
                  label={`Step ${index + 1}`}
                  data={TITLES}
                  allowDeselect={false}
                  value={step.do}
                  onChange={(kind) => {
                    const first = Object.entries(KINDS).find(([each]) => each === kind)?.[1].first;
                    if (first) onChange(steps.map((each, at) => (at === index ? first : each)));
                  }}
                />
                <Group gap={2} className="push">
                  <ActionIcon
                    aria-label={`Step ${index + 1} up`}
                    disabled={index === 0}
                    onClick={() => onChange(moved(steps, index, index - 1))}
                  >
                    <IconArrowUp size={15} />
                  </ActionIcon>
                  <ActionIcon
                    aria-label={`Step ${index + 1} down`}
                    disabled={index === steps.length - 1}
                    onClick={() => onChange(moved(steps, index, index + 1))}
                  >
                    <IconArrowDown size={15} />
                  </ActionIcon>
                  <ActionIcon
                    aria-label={`Delete step ${index + 1}`}
                    onClick={() => onChange(steps.filter((_, at) => at !== index))}
                  >
                    <IconTrash size={15} />
                  </ActionIcon>
                </Group>
              </div>
              {fieldsOf(step).map((field) => (
                <Field
                  key={field.key}
                  step={step}
                  field={field}
                  onChange={(next) => onChange(steps.map((each, at) => (at === index ? next : each)))}
                />
              ))}
            </fieldset>
          </li>
        ))}
      </ol>
      <Group gap={6}>
        <Button size="compact-sm" variant="default" onClick={() => onChange([...steps, KINDS.move.first])}>
          Add a step
        </Button>
      </Group>
    </div>
  );
}

function Field({ step, field, onChange }: { step: Step; field: StepField; onChange: (step: Step) => void }) {
  const said = shown(step, field);
  const [text, setText] = useState(said);
  const [seen, setSeen] = useState(said);
  if (said !== seen) {
    setSeen(said);
    setText(said);
  }
  if (field.choices)
    return (
      <Select
        size="xs"
        w={118}
        label={field.label}
        data={Object.entries(field.choices).map(([value, label]) => ({ value, label }))}
        allowDeselect={false}
        value={said}
        onChange={(value) => {
          const next = value === null ? null : written(step, field, value);
          if (next) onChange(next);
        }}
      />
    );
  const wide = field.kind === "list" || field.kind === "to" || field.kind === "text";
  const wrong = written(step, field, text) === null;
  return (
    <TextInput
      size="xs"
      w={field.kind === "step" ? "100%" : wide ? 200 : 100}
      label={field.label}
      value={text}
      error={wrong && "cannot stand here"}
      rightSection={field.unit && <span className="hint">{field.unit}</span>}
      onChange={(event) => {
        setText(event.currentTarget.value);
        const next = written(step, field, event.currentTarget.value);
        if (next === null) return;
        setSeen(shown(next, field)); // what is being typed stays as it is typed
        onChange(next);
      }}
    />
  );
}
