import { Alert, Button, Group, JsonInput, SegmentedControl, TextInput } from "@mantine/core";
import { useState } from "react";
import { api } from "../../api/client";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useWork } from "../../lib/useWork";
import { MacroSteps } from "./MacroSteps";
import type { Opened } from "./MacrosPanel";
import { linesOf, stepsOf } from "./macroSteps";

/** A macro's name and its steps: as a form, or as they are kept, one a line; the server judges. */
export function MacroEditor({ opened, onClose }: { opened: Opened; onClose: () => void }) {
  const [name, setName] = useState(opened.document.name);
  const [text, setText] = useState(() => linesOf(opened.document.steps));
  const [view, setView] = useState("form");
  const steps = stepsOf(text);
  const save = useWork(async () => {
    if (steps === null) return;
    const document = { ...opened.document, name, steps };
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
      <SegmentedControl
        size="xs"
        aria-label="Steps as"
        data={[
          { value: "form", label: "Form", disabled: steps === null },
          { value: "json", label: "JSON" },
        ]}
        value={view}
        onChange={setView}
      />
      {view === "form" && steps !== null ? (
        <MacroSteps steps={steps} onChange={(next) => setText(linesOf(next))} />
      ) : (
        <JsonInput
          label="Steps, one a line"
          error={steps === null && "These are no steps"}
          autosize
          minRows={4}
          maxRows={16}
          value={text}
          onChange={setText}
        />
      )}
      <ProblemAlert error={save.error ?? remove.error} doing="Keeping the macro" />
      <Group gap={6}>
        <Button size="compact-sm" disabled={steps === null} onClick={save.mutate}>
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
