import { Checkbox, Text, UnstyledButton } from "@mantine/core";
import { useState } from "react";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { useScheme } from "../../lib/useScheme";
import type { RecordingDetail } from "./api";
import { colorOfMark } from "./flags";
import classes from "./recordings.module.css";
import type { Window } from "./ZoomData";

const SHOWN = 200;
const WORDS: Record<string, string> = {
  write: "writes",
  command: "commands",
  event: "chip events",
  program: "program",
};

/** What happened, in order; each leads to its place in the plots. */
export function MarkList({ detail, onGo }: { detail: RecordingDetail; onGo: (window: Window) => void }) {
  const scheme = useScheme();
  const [without, setWithout] = useState<ReadonlySet<string>>(new Set());
  const zero = detail.zero_s ?? 0;
  const marks = detail.marks.filter(({ kind }) => !without.has(kind));
  const half = Math.max(0.05, detail.duration_s / 40);
  return (
    <Card
      title="Marks"
      note={`${detail.marks.length}`}
      actions={Object.entries(WORDS)
        .filter(([kind]) => detail.marks.some((mark) => mark.kind === kind))
        .map(([kind, words]) => (
          <Checkbox
            key={kind}
            label={words}
            checked={!without.has(kind)}
            onChange={(event) => {
              const next = new Set(without);
              if (event.currentTarget.checked) next.delete(kind);
              else next.add(kind);
              setWithout(next);
            }}
          />
        ))}
    >
      {marks.length === 0 ? (
        <Text size="xs" c="dimmed">
          Moves, stops, commands, register writes and your own notes stand here.
        </Text>
      ) : (
        <ol className={`tall list scroll`} data-testid="marks">
          {marks.slice(0, SHOWN).map((mark, index) => {
            const at = mark.time_s - zero;
            return (
              // biome-ignore lint/suspicious/noArrayIndexKey: marks only come behind each other
              <li key={index}>
                <UnstyledButton
                  className={`${classes.mark} lit grid baseline gap-8 text-13 anywhere w-full`}
                  onClick={() => onGo([at - half, at + half])}
                >
                  <span className="num">{fixed(at, 3, "s")}</span>
                  <span
                    className="swatch swatch-square"
                    style={{ background: colorOfMark(mark, scheme) }}
                    aria-hidden
                  />
                  <span>
                    {mark.text}
                    <span className="dim">
                      {" "}
                      {mark.kind}
                      {mark.axis === null ? "" : `, axis ${mark.axis}`}
                    </span>
                  </span>
                </UnstyledButton>
              </li>
            );
          })}
        </ol>
      )}
      {marks.length > SHOWN && (
        <Text size="xs" c="dimmed">
          and {marks.length - SHOWN} more
        </Text>
      )}
    </Card>
  );
}
