import { Text } from "@mantine/core";
import { Card } from "../../lib/Card";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { dateTimeOf } from "../../lib/time";
import type { StudyInfo } from "./study";

interface Props {
  studies: readonly StudyInfo[];
  error: unknown;
  shown: string | null;
  onPick: (id: string) => void;
  retry: () => void;
}

/** All studies of the axis, the latest first. */
export function StudyList({ studies, error, shown, onPick, retry }: Props) {
  return (
    <Card title="Studies" note={studies.length > 0 ? String(studies.length) : undefined}>
      <ProblemAlert error={error} doing="Listing the studies" retry={retry} />
      {studies.length === 0 && !error && (
        <Text size="sm" className="dim">
          None of this axis yet.
        </Text>
      )}
      <ul className="list">
        {studies.map((study) => (
          <li key={study.id}>
            <button
              type="button"
              className="plain lit"
              aria-current={study.id === shown}
              onClick={() => onPick(study.id)}
              style={{ width: "100%", padding: "6px 8px" }}
            >
              <Text size="sm" fw={study.id === shown ? 700 : 400}>
                {study.title}, {dateTimeOf(study.started_unix_s * 1000)}
              </Text>
              <Text size="sm" className="dim" lineClamp={3}>
                {study.state === "running" ? study.message : study.verdict || study.message || study.state}
              </Text>
            </button>
          </li>
        ))}
      </ul>
    </Card>
  );
}
