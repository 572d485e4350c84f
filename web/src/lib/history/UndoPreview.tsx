import { Alert, Button, Checkbox, Group, Text } from "@mantine/core";
import { IconCheck } from "@tabler/icons-react";
import { useState } from "react";
import type { Schemas } from "../../api/client";
import { fixed } from "../format";
import { Loading } from "../Loading";
import { ProblemAlert } from "../ProblemAlert";
import { dateTimeOf } from "../time";
import type { Aim } from "./aim";
import css from "./history.module.css";
import { usePreview, usePutBack } from "./useUndo";

type Register = Schemas["UndoneRegister"];

const keyOf = ({ name, axis }: Register) => `${name} ${axis ?? ""}`;

/** What putting a device back would write, register by register; each can be left out, others' writes are asked about. */
export function UndoPreview({ aim, onBack }: { aim: Aim; onBack: () => void }) {
  const preview = usePreview(aim);
  const putBack = usePutBack(aim);
  const [changed, setChanged] = useState<Readonly<Record<string, boolean>>>({});
  const told = preview.data;
  const wanted = (each: Register) => each.state !== "cannot" && (changed[keyOf(each)] ?? each.state === "ready");
  const chosen = told?.registers.filter(wanted) ?? [];
  const send = () =>
    told && putBack.mutate({ registers: chosen.map(({ name, axis }) => ({ name, axis })), seen: told.seen });
  return (
    <section className="grid gap-8" aria-label="Preview" data-testid="undo-preview">
      <h3 className="m-0 text-14 bold">{aim.title}</h3>
      {preview.isError && <ProblemAlert error={preview.error} doing="Looking what would be put back" />}
      {preview.isLoading && <Loading size="sm" label="Looking what would be put back" />}
      {putBack.isSuccess ? (
        <Done answer={putBack.data} onClose={onBack} />
      ) : (
        told && (
          <>
            {told.registers.length === 0 ? (
              <Text size="sm" role="status">
                All that the log tells of is as it was{told.same > 0 && `: ${fixed(told.same)} registers`}.
              </Text>
            ) : (
              <ul className={`${css.registers} list`} aria-label="Registers">
                {told.registers.map((each) => (
                  <Line
                    key={keyOf(each)}
                    register={each}
                    checked={wanted(each)}
                    onChecked={(on) => setChanged({ ...changed, [keyOf(each)]: on })}
                  />
                ))}
              </ul>
            )}
            <Left told={told} />
          </>
        )
      )}
      {putBack.isError && <ProblemAlert error={putBack.error} doing="Putting it back" />}
      {!putBack.isSuccess && (
        <Group gap="xs">
          <Button size="compact-sm" disabled={chosen.length === 0} loading={putBack.isPending} onClick={send}>
            {chosen.length === 0 ? "Nothing to put back" : `Put back ${fixed(chosen.length)}`}
          </Button>
          {putBack.isError && (
            <Button
              size="compact-sm"
              variant="default"
              onClick={() => {
                putBack.reset();
                void preview.refetch();
              }}
            >
              Look again
            </Button>
          )}
          <Button size="compact-sm" variant="default" onClick={onBack}>
            Back to the list
          </Button>
        </Group>
      )}
    </section>
  );
}

function shown(value: Register["was"], physical: string, unit: string): string {
  if (value === null) return "?";
  const number = typeof value === "number" && Number.isInteger(value) ? fixed(value) : String(value);
  return physical === "" ? `${number} ${unit}`.trim() : `${number} (${physical})`;
}

interface LineProps {
  register: Register;
  checked: boolean;
  onChecked: (on: boolean) => void;
}

function Line({ register, checked, onChecked }: LineProps) {
  const { name, axis, state, why, since, unit } = register;
  const last = since.at(-1);
  const place = axis === null ? name : `${name}, axis ${axis}`;
  return (
    <li data-state={state} className="grid gap-2">
      {state === "cannot" ? (
        <span className="bold text-13">{place}</span>
      ) : (
        <Checkbox
          size="xs"
          label={<span className="bold text-13">{place}</span>}
          checked={checked}
          onChange={(event) => onChecked(event.currentTarget.checked)}
        />
      )}
      <span className={`${css.values} num text-12`}>
        {shown(register.now, register.now_physical, unit)} → {shown(register.was, register.was_physical, unit)}
      </span>
      {why !== "" && (
        <span className={`${css.values} text-12 ${state === "ready" ? "dim" : "caution"}`}>
          {state === "cannot" && "stays: "}
          {why}
          {last && `, last ${dateTimeOf(Date.parse(last.time))}: ${last.new ?? "?"}`}
        </span>
      )}
    </li>
  );
}

/** What is not put back, whatever is chosen. */
function Left({ told }: { told: Schemas["UndoAnswer"] }) {
  if (told.rest.length === 0 && told.unseen.length === 0) return null;
  return (
    <details className="text-12">
      <summary>
        Not put back: {fixed(told.rest.length)} {told.rest.length === 1 ? "action" : "actions"}
        {told.unseen.length > 0 && `, ${fixed(told.unseen.length)} registers that the log has never seen`}
      </summary>
      <ul className="list grid gap-4 mt-8">
        {told.rest.map((each) => (
          <li key={`${each.action} ${each.subject}`}>
            <b>
              {each.action} {each.subject}
            </b>
            {each.count > 1 && ` × ${fixed(each.count)}`}
            <span className="dim">: {each.why}</span>
          </li>
        ))}
        {told.unseen.length > 0 && (
          <li className="dim anywhere">
            Never seen: {told.unseen.map(({ name, axis }) => (axis === null ? name : `${name}.${axis}`)).join(", ")}
          </li>
        )}
      </ul>
    </details>
  );
}

function Done({ answer, onClose }: { answer: Schemas["UndoAnswer"]; onClose: () => void }) {
  const written = answer.applied?.written.length ?? 0;
  const settings = answer.applied?.settings.length ?? 0;
  return (
    <Alert
      color="gray"
      p="sm"
      role="status"
      icon={<IconCheck size={18} aria-hidden />}
      title={answer.state === "applied" ? "It is put back" : "Nothing was to do"}
      withCloseButton
      closeButtonLabel="Back to the list"
      onClose={onClose}
    >
      <Text size="sm">
        {fixed(written)} {written === 1 ? "register" : "registers"} written and read back
        {settings > 0 && `, ${fixed(settings)} settings of the connection changed`}. This is a change as well, and can
        be undone.
      </Text>
      {answer.applied?.prepared.map((each) => (
        <Text key={each} size="sm">
          {each}
        </Text>
      ))}
    </Alert>
  );
}
