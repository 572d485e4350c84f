import { Button, Select, Text, TextInput } from "@mantine/core";
import { useState } from "react";
import { FormulaError, FUNCTIONS } from "../../../../lib/formula/compile";
import { unitText } from "../../../../lib/formula/dimension";
import type { Derived } from "../settings";
import { type Channels, compiled, pathOf } from "./plan";

const LETTERS = ["a", "b", "c", "x"] as const;
const DERIVED_MAX = 20;

interface Props {
  channels: Channels;
  derived: Readonly<Record<string, Derived>>;
  onSave: (name: string, made: Derived) => void;
}

/** A derived channel: a formula of up to four channels, judged at each key. */
export function FormulaForm({ channels, derived, onSave }: Props) {
  const [name, setName] = useState("");
  const [formula, setFormula] = useState("a - b");
  const [inputs, setInputs] = useState<Record<string, string>>({});
  const offered = channels.devices.flatMap((device) =>
    device.channels.map((channel) => ({
      value: pathOf(device.id, channel.name),
      label: channels.label(pathOf(device.id, channel.name)),
    })),
  );
  const made: Derived = { formula, inputs };
  const verdict = judged(made, channels);
  const full = Object.keys(derived).length >= DERIVED_MAX && !Object.hasOwn(derived, name);
  const named = /^\w[\w -]{0,30}$/.test(name);
  return (
    <form
      className="stack gap-6"
      aria-label="Derive by a formula"
      onSubmit={(event) => {
        event.preventDefault();
        if (verdict.at === null && named && !full) onSave(name, made);
      }}
    >
      <TextInput size="xs" label="Name" value={name} onChange={(event) => setName(event.currentTarget.value)} />
      {LETTERS.map((letter, index) =>
        index <= Object.keys(inputs).length ? (
          <Select
            key={letter}
            size="xs"
            label={letter}
            searchable
            clearable
            limit={50}
            placeholder="a channel"
            data={offered}
            value={inputs[letter] ?? null}
            onChange={(path) => {
              const { [letter]: _, ...others } = inputs;
              setInputs(path === null ? others : { ...inputs, [letter]: path });
            }}
          />
        ) : null,
      )}
      <TextInput
        size="xs"
        label="Formula"
        value={formula}
        spellCheck={false}
        onChange={(event) => setFormula(event.currentTarget.value)}
        description={FUNCTIONS.join(" ")}
        inputWrapperOrder={["label", "input", "description"]}
      />
      {verdict.at !== null && (
        <pre className="m-0 text-12 mono" aria-hidden>
          {formula}
          {"\n"}
          {" ".repeat(verdict.at)}^
        </pre>
      )}
      <Text size="xs" c={verdict.at === null ? "dimmed" : "red"} role="status" data-testid="formula-verdict">
        {full ? `${DERIVED_MAX} derived channels are the most` : verdict.text}
      </Text>
      <Button size="compact-sm" type="submit" disabled={verdict.at !== null || !named || full}>
        Add
      </Button>
    </form>
  );
}

function judged(made: Derived, channels: Channels): { text: string; at: number | null } {
  try {
    const unit = unitText(compiled(made, channels).dimension);
    return { text: unit === "" ? "A plain number" : `In ${unit}`, at: null };
  } catch (error) {
    if (!(error instanceof FormulaError)) throw error;
    return { text: error.message, at: error.at };
  }
}
