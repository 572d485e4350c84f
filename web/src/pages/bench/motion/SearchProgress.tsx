import { Progress, Text } from "@mantine/core";
import type { Schemas } from "../../../api/client";

interface Props {
  search: Schemas["ReferenceSearchState"] | undefined;
  label: string;
  testId?: string;
  /** before it has ever run */
  idle: string;
  /** what is said of it while it runs, by default its phase; and once it is done */
  running?: (search: Schemas["ReferenceSearchState"]) => string;
  done?: (search: Schemas["ReferenceSearchState"]) => string;
}

/** How far a reference search is, and what came of it. */
export function SearchProgress({ search, label, testId, idle, running, done }: Props) {
  const failed = search?.state === "failed";
  const outcome = () => {
    if (search === undefined) return "";
    if (search.state === "idle") return idle;
    if (search.state === "running") return running?.(search) ?? search.phase;
    return (search.state === "done" && done?.(search)) || search.message || `The search was ${search.state}.`;
  };
  return (
    <>
      <Progress value={100 * (search?.progress ?? 0)} size={6} color={failed ? "red" : "accent"} aria-label={label} />
      <Text
        size="xs"
        c={failed ? "red" : "dimmed"}
        mih={36}
        role="status"
        data-testid={testId}
        data-state={search?.state}
      >
        {outcome()}
      </Text>
    </>
  );
}
