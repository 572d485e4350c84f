import { Group, Text } from "@mantine/core";
import type { Schemas } from "../../api/client";
import type { Standing } from "../../live/conditions";
import { fixed } from "../format";
import { ProblemAlert } from "../ProblemAlert";
import { ConditionMark } from "./ConditionMark";
import { referencedWords, sentence, sinceWords } from "./kinds";
import { RemedyButton } from "./RemedyButton";
import { useRemedies } from "./remedy";

interface Props {
  standing: Standing;
  /** as just read: its figures are newer */
  read: Schemas["AxisStateOut"] | undefined;
}

/** Why an axis is in its condition: the cause, what was seen, since when, and everything that helps. */
export function ConditionDetail({ standing, read }: Props) {
  const remedies = useRemedies();
  const { condition, ground_truth: truth } = standing;
  const newest = read?.condition.kind === condition.kind ? read.condition : condition;
  return (
    <div className="stack gap-8 text-13">
      <Group justify="space-between" wrap="nowrap">
        <ConditionMark kind={condition.kind} size={18} />
        <span className="ink text-12 nowrap">{sinceWords(condition, read?.time_s)}</span>
      </Group>
      <Text size="sm">{sentence(newest.cause)}.</Text>
      <Text size="xs">{referencedWords(standing.referenced)}</Text>
      {truth && (
        <Text size="xs">
          <b>Really, in the emulator:</b> {truth.summary}
        </Text>
      )}
      {newest.evidence.length > 0 && (
        <table className="figures" aria-label="Evidence">
          <tbody>
            {newest.evidence.map(({ what, value, seen_s }) => (
              <tr key={what}>
                <th scope="row">{what}</th>
                <td className="mono anywhere">{value}</td>
                <td className="num">{seen_s === null ? "" : `at ${fixed(seen_s, 2, "s")}`}</td>
              </tr>
            ))}
          </tbody>
        </table>
      )}
      {condition.remedies.length > 0 && (
        <Group gap={6}>
          {condition.remedies.map((remedy, index) => (
            <RemedyButton
              key={`${remedy.method} ${remedy.path} ${remedy.label}`}
              remedy={remedy}
              remedies={remedies}
              main={index === 0}
            />
          ))}
        </Group>
      )}
      {remedies.isError && (
        <ProblemAlert error={remedies.error} doing={sentence(remedies.variables.label)} onClose={remedies.reset} />
      )}
    </div>
  );
}
