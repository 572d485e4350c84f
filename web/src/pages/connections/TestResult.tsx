import { Alert } from "@mantine/core";
import { IconCheck } from "@tabler/icons-react";
import type { Schemas } from "../../api/client";
import { duration } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";

interface Props {
  test: Schemas["LinkTest"] | undefined;
  error: unknown;
  pending: boolean;
  /** what was tried is still what the form says */
  current: boolean;
  emulated: boolean;
  /** the command that serves an emulated device as the peer; null where there is none */
  emulate: string | null;
}

/** What a trial of the link found: the round trip, or what went wrong and what to do. */
export function TestResult({ test, error, pending, current, emulated, emulate }: Props) {
  if (pending || !current) return null;
  if (error !== null) return <ProblemAlert error={error} doing="Testing" />;
  if (test === undefined) return null;
  if (!test.ok)
    return (
      <>
        <ProblemAlert error={test.problem ?? new Error(test.detail)} doing="The link does not work" />
        {emulate !== null && (
          <p className="hint m-0 mt-4">
            To see it work without hardware, serve an emulated one there: <code>{emulate}</code>
          </p>
        )}
      </>
    );
  return (
    <Alert
      p="xs"
      role="status"
      icon={<IconCheck size={16} aria-hidden />}
      title={
        <>
          It answers
          {test.round_trip_ms !== null && (
            <>
              {" "}
              in <span className="num">{duration(test.round_trip_ms / 1000)}</span>
            </>
          )}
        </>
      }
    >
      <span className="text-12">
        {test.detail}
        {emulated && " A trial emulator was made and thrown away."}
      </span>
    </Alert>
  );
}
