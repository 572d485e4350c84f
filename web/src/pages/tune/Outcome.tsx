import { Alert, Anchor, Button, Group, Progress, Table, Text } from "@mantine/core";
import { Link } from "wouter";
import { Card } from "../../lib/Card";
import { compact, duration } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { titleOf } from "./kinds";
import { Phases } from "./Phases";
import { type Study, sentencesOf, twinTold } from "./study";
import classes from "./tune.module.css";
import { type Changes, useStudies } from "./useStudies";

/** How it ended, for the eye: better, failed, or neither. */
function outcomeOf({ state, improved }: Study): "running" | "better" | "failed" | "same" {
  if (state === "running") return "running";
  if (state !== "done") return "failed";
  return improved ? "better" : "same";
}

/** How far a study is, what came of it in one sentence, and what to do with that. */
export function Outcome({ study, changes }: { study: Study; changes: Changes }) {
  const { id } = study;
  const running = study.state === "running";
  const best = study.trials.find(({ number }) => number === study.best);
  const [first, ...grounds] = sentencesOf(running ? study.message : study.verdict || study.message || study.state);
  const goesOn = useStudies().data?.kinds.find(({ kind }) => kind === study.document.study.kind)?.goes_on;
  const twin = twinTold(study);
  const failed = [changes.stop, changes.resume, changes.best, changes.undo, changes.keep, changes.remove];
  return (
    <Card
      title={titleOf(study.document)}
      note={running ? study.phase : study.state}
      actions={
        running ? (
          <Button
            size="compact-sm"
            color="red"
            loading={changes.stop.isPending}
            onClick={() => changes.stop.mutate(id)}
          >
            Stop, and set back
          </Button>
        ) : (
          <Button
            size="compact-sm"
            variant="default"
            loading={changes.remove.isPending}
            onClick={() => changes.remove.mutate(id)}
          >
            Delete
          </Button>
        )
      }
    >
      {running && <Phases study={study} />}
      {running && (
        <div className="row gap-8 mid" style={{ marginBottom: 8 }}>
          <Progress value={study.progress * 100} size="lg" aria-label="How far the study is" style={{ flex: 1 }} />
          <span className="num text-13">{Math.round(study.progress * 100)} %</span>
        </div>
      )}
      <div role="status" data-testid="verdict" data-outcome={outcomeOf(study)} className={classes.verdict}>
        <b>{first}</b>
        {grounds.map((ground) => (
          <p key={ground} className="m-0">
            {ground}
          </p>
        ))}
      </div>
      {running && (
        <Text size="sm" mt={4}>
          {study.left_s === null ? "How long it takes yet is not known." : `About ${duration(study.left_s)} left.`}
        </Text>
      )}
      {study.left.length > 0 && (
        <Alert color="red" role="alert" mt="xs" title="Not as before">
          {study.left.map((line) => (
            <Text key={line} size="sm">
              {line}
            </Text>
          ))}
        </Alert>
      )}
      {best && Object.keys(study.units).length > 0 && (
        <Table mt="xs" withRowBorders={false} verticalSpacing={2} aria-label="Before and best">
          <Table.Thead>
            <Table.Tr>
              <Table.Th scope="col">Setting</Table.Th>
              <Table.Th scope="col">Before</Table.Th>
              <Table.Th scope="col">Best</Table.Th>
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {Object.entries(study.units).map(([name, unit]) => (
              <Table.Tr key={name}>
                <Table.Th scope="row">{unit === "" ? name : `${name} [${unit}]`}</Table.Th>
                <Table.Td className="num">{compact(study.baseline_setting[name], 6)}</Table.Td>
                <Table.Td className="num">{compact(best.setting[name], 6)}</Table.Td>
              </Table.Tr>
            ))}
            {study.baseline_figures && (
              <Table.Tr>
                <Table.Th scope="row">time [s]</Table.Th>
                <Table.Td className="num">{compact(study.baseline_figures.time_s)}</Table.Td>
                <Table.Td className="num">{compact(best.figures.time_s)}</Table.Td>
              </Table.Tr>
            )}
            {study.baseline_figures && study.front.length > 0 && (
              <Table.Tr>
                <Table.Th scope="row">peak deviation [full steps]</Table.Th>
                <Table.Td className="num">{compact(study.baseline_figures.deviation_fullsteps, 3)}</Table.Td>
                <Table.Td className="num">{compact(best.figures.deviation_fullsteps, 3)}</Table.Td>
              </Table.Tr>
            )}
          </Table.Tbody>
        </Table>
      )}
      {!running && (
        <Group gap="xs" mt="sm">
          {study.improved && best && (
            <Button size="compact-sm" loading={changes.best.isPending} onClick={() => changes.best.mutate(id)}>
              Take the best
            </Button>
          )}
          {study.baseline.length > 0 && (
            <Button
              size="compact-sm"
              variant="default"
              loading={changes.undo.isPending}
              onClick={() => changes.undo.mutate(id)}
            >
              {study.left.length > 0 ? "Set back" : "Undo: as before"}
            </Button>
          )}
          {best && (
            <Button
              size="compact-sm"
              variant="default"
              loading={changes.keep.isPending}
              onClick={() => changes.keep.mutate(id)}
            >
              Keep both as profiles
            </Button>
          )}
          {study.state !== "done" && (
            <Button
              size="compact-sm"
              variant="default"
              loading={changes.resume.isPending}
              onClick={() => changes.resume.mutate(id)}
            >
              {goesOn ? "Go on (moves)" : "Begin again (moves)"}
            </Button>
          )}
          <Anchor size="sm" href={`/api/v1/studies/${id}/report`} download>
            Report
          </Anchor>
          {study.recording && (
            <Anchor size="sm" component={Link} href={`/recordings/${study.recording}`}>
              Recording
            </Anchor>
          )}
        </Group>
      )}
      {study.taken && study.front.length > 0 && (
        <Text size="sm" mt={4} role="status">
          Taken: trial {study.taken.trial}, {study.taken.proved ? "proved" : "not proved"}.
        </Text>
      )}
      {changes.keep.data && changes.keep.variables === id && (
        <Text size="sm" mt={4} role="status">
          Kept: {changes.keep.data.profiles.map(({ name }) => name).join("; ")}.
        </Text>
      )}
      {failed.map((mutation) =>
        mutation.error && mutation.variables === id ? (
          <ProblemAlert
            key={mutation.submittedAt}
            error={mutation.error}
            doing="The study"
            onClose={() => mutation.reset()}
          />
        ) : null,
      )}
      {study.next && !running && (
        <Text size="sm" className="dim" mt={4}>
          Next: {study.next}.
        </Text>
      )}
      {twin && (
        <Text size="sm" className="dim" mt={4}>
          {twin}
        </Text>
      )}
    </Card>
  );
}
