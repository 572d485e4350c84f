import { ActionIcon, Button, Group, Text, TextInput } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { useState } from "react";
import { Card } from "../../lib/Card";
import { placeName } from "./lines";
import css from "./program.module.css";
import type { WatchState } from "./WatchSource";

interface Props {
  watch: WatchState;
  labels: Readonly<Record<string, number>>;
  variables: readonly number[];
  onVariables: (variables: number[]) => void;
}

const hex = (value: number) => `0x${(value >>> 0).toString(16).toUpperCase().padStart(8, "0")}`;

/** Counter, registers, flags, stack and watched variables, as the device tells them. */
export function StatePanel({ watch, labels, variables, onVariables }: Props) {
  const { seen, lost, rateHz } = watch;
  const untold = <span className="dim">the module does not tell</span>;
  const note =
    lost !== "" ? "not known" : rateHz === null ? "" : `up to ${Math.round(rateHz * 10) / 10} looks a second`;
  return (
    <Card title="State" note={note} data-testid="program-state">
      {lost !== "" && (
        <Text size="sm" className="dim" role="status">
          {lost}
        </Text>
      )}
      {seen && (
        <dl className={`${css.figures} fades text-13`} data-stale={lost !== ""}>
          <dt>Program</dt>
          <dd data-testid="program-status">
            {seen.debug.state === "running" ? "single steps" : seen.downloading ? "download mode" : seen.status}
            {seen.waits === true && ", waits"}
            {seen.interrupted === true && ", in an interrupt"}
          </dd>
          <dt>Counter</dt>
          <dd className="num" data-testid="program-counter">
            {placeName(labels, seen.counter)}
          </dd>
          <dt>Accumulator</dt>
          <dd className="num" title={hex(seen.accumulator)}>
            {seen.accumulator} <span className="dim">{hex(seen.accumulator)}</span>
          </dd>
          <dt>X</dt>
          <dd className="num">
            {seen.x} <span className="dim">{hex(seen.x)}</span>
          </dd>
          <dt>Flags</dt>
          <dd>{seen.flags === null ? untold : seen.flags.join(", ") || "none"}</dd>
          <dt>Stack</dt>
          <dd className="num">
            {seen.stack === null ? untold : seen.stack.map((at) => placeName(labels, at)).join(", ") || "empty"}
          </dd>
          {seen.error !== null && seen.error !== 0 && (
            <>
              <dt>Refused</dt>
              <dd className={css.problem}>status {seen.error} at the latest command that was refused</dd>
            </>
          )}
        </dl>
      )}
      <Variables seen={seen?.variables ?? {}} variables={variables} onVariables={onVariables} />
      {watch.refused !== "" && (
        <Text size="sm" className={css.problem} role="alert">
          {watch.refused}
        </Text>
      )}
    </Card>
  );
}

function Variables({
  seen,
  variables,
  onVariables,
}: {
  seen: Readonly<Record<string, number>>;
  variables: readonly number[];
  onVariables: (variables: number[]) => void;
}) {
  const [number, setNumber] = useState("");
  const wanted = /^\d{1,3}$/.test(number) ? Number(number) : null;
  const fits = wanted !== null && wanted <= 255 && !variables.includes(wanted) && variables.length < 64;
  return (
    <>
      <h3 className="m-0 mt-8 text-13 bold">Variables</h3>
      {variables.length > 0 && (
        <ul className="list text-13" aria-label="Watched variables">
          {variables.map((each) => (
            <li key={each} className="row gap-8">
              <span className="dim">variable {each}</span>
              <span className="num push" data-testid={`variable-${each}`}>
                {seen[each] ?? "–"}
              </span>
              <ActionIcon
                size="sm"
                aria-label={`Watch variable ${each} no more`}
                onClick={() => onVariables(variables.filter((other) => other !== each))}
              >
                <IconX size={14} />
              </ActionIcon>
            </li>
          ))}
        </ul>
      )}
      <form
        onSubmit={(event) => {
          event.preventDefault();
          if (!fits || wanted === null) return;
          onVariables([...variables, wanted].sort((one, other) => one - other));
          setNumber("");
        }}
      >
        <Group gap={6} mt={4} wrap="nowrap">
          <TextInput
            flex={1}
            aria-label="Number of a user variable"
            placeholder="number, 0 to 255"
            inputMode="numeric"
            value={number}
            onChange={({ currentTarget }) => setNumber(currentTarget.value)}
            error={number !== "" && !fits && "A number from 0 to 255 that is not watched yet"}
          />
          <Button variant="default" type="submit" disabled={!fits}>
            Watch
          </Button>
        </Group>
      </form>
    </>
  );
}
