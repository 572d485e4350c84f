import { Button, Group, Text, UnstyledButton } from "@mantine/core";
import { useEffect, useState } from "react";
import type { Device } from "../../api/queries";
import { Loading } from "../Loading";
import { ProblemAlert } from "../ProblemAlert";
import { dateTimeOf, timeOf } from "../time";
import { type Aim, beforeChange, changeText, minutesAgo, withoutChange } from "./aim";
import { goTo, useSteps } from "./history";
import css from "./history.module.css";
import { UndoPreview } from "./UndoPreview";
import { UndoRedo } from "./UndoRedo";
import { useChanges } from "./useUndo";

interface Props {
  device: Device | undefined;
  /** a preview to begin with */
  aim?: Aim | null;
}

/** All that can be taken back: what was designed and staged on this page, and what was written into a device. */
export function HistoryPanel({ device, aim = null }: Props) {
  const [looking, look] = useState<Aim | null>(aim);
  useEffect(() => look(aim), [aim]);
  if (looking) return <UndoPreview key={JSON.stringify(looking.order)} aim={looking} onBack={() => look(null)} />;
  return (
    <div className="grid gap-16 text-13">
      <PageSteps />
      {device && <Changes device={device} look={look} />}
    </div>
  );
}

function PageSteps() {
  const { past, future } = useSteps();
  const lines = [
    ...[...future].reverse().map((step) => ({ ...step, done: false })),
    ...[...past].reverse().map((step) => ({ ...step, done: true })),
  ];
  const current = past.at(-1)?.id ?? 0;
  return (
    <section aria-label="On this page">
      <Group justify="space-between" mb={4}>
        <h3 className="m-0 text-14 bold">On this page</h3>
        <Group gap={4}>
          <UndoRedo />
        </Group>
      </Group>
      {lines.length === 0 ? (
        <Text className="hint">Designs and staged edits are listed here as you make them. Ctrl Z takes one back.</Text>
      ) : (
        <ol className={`${css.steps} list`}>
          {lines.map(({ id, label, at, done, asks }) => (
            <li key={id} data-done={done} data-current={id === current}>
              <UnstyledButton
                className={`${css.step} row between gap-8 text-13`}
                aria-current={id === current ? "step" : undefined}
                disabled={asks}
                title={done ? "Undo what came behind it" : "Redo up to here"}
                onClick={() => goTo(id)}
              >
                <span className="anywhere">{label}</span>
                <time className="dim num text-12">{timeOf(at)}</time>
              </UnstyledButton>
            </li>
          ))}
          <li data-current={current === 0}>
            <UnstyledButton className={`${css.step} row between text-13 dim`} onClick={() => goTo(0)}>
              As it began
            </UnstyledButton>
          </li>
        </ol>
      )}
    </section>
  );
}

const AGO = [10, 60];

function Changes({ device, look }: { device: Device; look: (aim: Aim) => void }) {
  const { changes, error, hasNextPage, isFetchingNextPage, fetchNextPage } = useChanges(device.id);
  return (
    <section aria-label={`Written into ${device.name}`}>
      <h3 className="m-0 text-14 bold">Written into {device.name}</h3>
      <Group gap="xs" my={8}>
        {AGO.map((minutes) => (
          <Button
            key={minutes}
            size="compact-xs"
            variant="default"
            onClick={() => look(minutesAgo(device.id, minutes))}
          >
            {minutesAgo(device.id, minutes).title}
          </Button>
        ))}
      </Group>
      {error !== null && <ProblemAlert error={error} doing="Reading the history" />}
      {changes === undefined && error === null && <Loading size="sm" label="Reading the history" />}
      {changes?.length === 0 && <Text className="hint">Nothing was done to it yet.</Text>}
      <ol className={`${css.changes} list`} data-testid="device-history">
        {changes?.map((change) => {
          const { entry, first, last, writes } = change;
          const text = changeText(change);
          return (
            <li key={last} className="grid gap-2" data-outcome={entry.outcome.startsWith("done") ? "done" : "not done"}>
              <span className="anywhere">{text}</span>
              <span className="row between wrap gap-4">
                <span className="dim text-12">
                  {entry.who}, <time dateTime={entry.time}>{dateTimeOf(Date.parse(entry.time))}</time>
                  {!entry.outcome.startsWith("done") && <span className="caution"> {entry.outcome}</span>}
                </span>
                {writes > 0 ? (
                  <Group gap={4}>
                    <Button
                      size="compact-xs"
                      variant="default"
                      aria-label={`Undo ${text}`}
                      onClick={() => look(withoutChange(device.id, last, text))}
                    >
                      Undo
                    </Button>
                    <Button
                      size="compact-xs"
                      variant="subtle"
                      aria-label={`As it was before ${text}`}
                      onClick={() => look(beforeChange(device.id, first, text))}
                    >
                      Before this
                    </Button>
                  </Group>
                ) : (
                  <span className="hint">not undone</span>
                )}
              </span>
            </li>
          );
        })}
      </ol>
      {hasNextPage && (
        <Button size="compact-sm" variant="default" loading={isFetchingNextPage} onClick={() => void fetchNextPage()}>
          Older
        </Button>
      )}
    </section>
  );
}
