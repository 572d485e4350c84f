import { Alert, Button, Group, JsonInput, TextInput } from "@mantine/core";
import { useState } from "react";
import { api, type Schemas } from "../../api/client";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useWork } from "../../lib/useWork";
import type { Opened } from "./MacrosPanel";

type Steps = Schemas["MacroDocument"]["steps"];

/** A macro's name and its steps as they are kept: one a line, to be changed, ordered and deleted; the server judges. */
export function MacroEditor({ opened, onClose }: { opened: Opened; onClose: () => void }) {
  const [name, setName] = useState(opened.document.name);
  const [text, setText] = useState(() => linesOf(opened.document.steps));
  const save = useWork(async () => {
    const document = { ...opened.document, name, steps: JSON.parse(text) as Steps };
    if (opened.id === null) await api.POST("/api/v1/macros", { body: { document } });
    else
      await api.PUT("/api/v1/macros/{macro}", {
        path: { macro: opened.id },
        body: { based_on: opened.revision, document },
      });
    onClose();
  });
  const remove = useWork(async () => {
    if (opened.id !== null) await api.DELETE("/api/v1/macros/{macro}", { path: { macro: opened.id } });
    onClose();
  });
  return (
    <section aria-label="Macro" className="stack gap-6" data-testid="macro-editor">
      {opened.leftOut.length > 0 && (
        <Alert color="yellow" p="xs" title="Left out">
          {opened.leftOut.map((line) => (
            <div key={line}>{line}</div>
          ))}
        </Alert>
      )}
      <TextInput label="Name" maxLength={80} value={name} onChange={(event) => setName(event.currentTarget.value)} />
      <JsonInput
        label="Steps, one a line"
        validationError="This is no JSON"
        autosize
        minRows={4}
        maxRows={16}
        value={text}
        onChange={setText}
      />
      <ProblemAlert error={save.error ?? remove.error} doing="Keeping the macro" />
      <Group gap={6}>
        <Button size="compact-sm" onClick={save.mutate}>
          Save
        </Button>
        <Button size="compact-sm" variant="default" onClick={onClose}>
          Cancel
        </Button>
        {opened.id !== null && (
          <Button size="compact-sm" variant="default" onClick={remove.mutate}>
            Delete
          </Button>
        )}
      </Group>
    </section>
  );
}

function linesOf(steps: Steps): string {
  return steps.length === 0 ? "[]" : `[\n${steps.map((step) => ` ${JSON.stringify(step)}`).join(",\n")}\n]`;
}
