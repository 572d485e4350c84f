import { ActionIcon, Text } from "@mantine/core";
import { IconTerminal2, IconTrash } from "@tabler/icons-react";
import { EmptyState } from "../../lib/EmptyState";
import { duration, fixed } from "../../lib/format";
import { timeOf } from "../../lib/time";
import { Bytes } from "./Bytes";
import css from "./console.module.css";
import { bytesOf, replyFields, requestFields } from "./frames";
import { type Entry, forget } from "./history";

interface Props {
  device: string;
  entries: readonly Entry[];
  onAgain: (line: string) => void;
}

/** What was sent and what came back, newest first. */
export function Entries({ device, entries, onAgain }: Props) {
  if (entries.length === 0)
    return (
      <EmptyState title="Nothing sent yet" icon={<IconTerminal2 size={22} />}>
        <Text size="sm" className="m-0 dim" maw={360}>
          Try <Example line="GAP 1, 0" onAgain={onAgain} /> for the actual position, or{" "}
          <Example line="136 STRING" onAgain={onAgain} /> for the firmware's version.
        </Text>
      </EmptyState>
    );
  return (
    <>
      <div className="row between">
        <h3 className="hint m-0 bold">Sent</h3>
        <ActionIcon size={22} aria-label="Clear the history" onClick={() => forget(device)}>
          <IconTrash size={14} />
        </ActionIcon>
      </div>
      <ol className="list mt-4" aria-label="Commands sent, newest first">
        {entries.map((entry) => (
          <li key={entry.id} className={`${css.entry} pad-s rule-top`} data-refused={refused(entry)}>
            <div className="lines-12 baseline">
              <button
                type="button"
                className={`plain lit text-13 bold mono`}
                title="Use it again"
                onClick={() => onAgain(entry.line)}
              >
                {entry.line}
              </button>
              <Result entry={entry} />
              <span className="num hint push">
                {entry.answer && duration(entry.answer.took_ms / 1000)}
                <span className="ml-8">{timeOf(entry.atMs)}</span>
              </span>
            </div>
            {entry.answer && <Exchange answer={entry.answer} />}
          </li>
        ))}
      </ol>
    </>
  );
}

function Example({ line, onAgain }: { line: string; onAgain: (line: string) => void }) {
  return (
    <button type="button" className="plain underlined accent text-12 mono" onClick={() => onAgain(line)}>
      {line}
    </button>
  );
}

/** 100 is done, 101 is stored in program memory; all else is a refusal. */
function refused(entry: Entry): boolean {
  const status = entry.answer?.status;
  return entry.problem !== null || (typeof status === "number" && status !== 100 && status !== 101);
}

function Result({ entry }: { entry: Entry }) {
  const { answer, problem } = entry;
  if (problem)
    return (
      <span className="m-0 fault" role="alert">
        <b>{problem.title}.</b> {problem.detail} {problem.way_out}
      </span>
    );
  if (answer === null) return null;
  if (answer.reply === null) return <span className="m-0 dim">the module does not answer to this</span>;
  return (
    <span className="inline wrap gap-8">
      {refused(entry) ? (
        <span className="m-0 fault">
          {answer.status} {answer.status_text}
        </span>
      ) : (
        <>
          <b className="num">{valueText(answer)}</b>
          <span className="m-0 dim">
            {answer.status} {answer.status_text}
          </span>
        </>
      )}
    </span>
  );
}

function valueText(answer: NonNullable<Entry["answer"]>): string {
  const fields = replyFields(bytesOf(answer.request), bytesOf(answer.reply ?? ""));
  const data = fields.find((field) => field.kind === "text");
  if (data) return data.meaning;
  return answer.value === null ? "" : fixed(answer.value);
}

function Exchange({ answer }: { answer: NonNullable<Entry["answer"]> }) {
  const request = bytesOf(answer.request);
  return (
    <div className="lines-24 mt-4">
      <Bytes label="request" fields={requestFields(request)} />
      {answer.reply !== null && <Bytes label="reply" fields={replyFields(request, bytesOf(answer.reply))} />}
    </div>
  );
}
