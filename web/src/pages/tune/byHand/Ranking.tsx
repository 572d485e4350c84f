import { Button, Group, NativeSelect, Table, Text } from "@mantine/core";
import { useState } from "react";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { dateTimeOf } from "../../../lib/time";
import { Together } from "../trials/TrialsCard";
import type { Changes } from "../useStudies";
import classes from "./byHand.module.css";
import {
  changedIn,
  differences,
  distancesOf,
  endedBy,
  FIGURES,
  type Figure,
  type Move,
  pointsOf,
  ranked,
  titleOf,
} from "./moves";

interface Props {
  moves: readonly Move[];
  changes: Changes;
  /** something of this axis runs */
  busy: boolean;
}

const SHOWN = (Object.keys(FIGURES) as Figure[]).filter((figure) => figure !== "reached");
const OPTIONS = Object.entries(FIGURES).map(([value, { label }]) => ({ value, label }));

/** All moves by hand of an axis, the best first, with what was changed between them, and the way to take one. */
export function Ranking({ moves, changes, busy }: Props) {
  const [by, setBy] = useState<Figure>("time_s");
  const [asked, setAsked] = useState<string | null>(null);
  const [chosen, setChosen] = useState<number | null>(null);
  const distances = distancesOf(moves);
  const distance = chosen !== null && distances.includes(chosen) ? chosen : distances[0];
  const latest = moves.reduce<Move | null>((late, move) => (late && late.id > move.id ? late : move), null);
  if (latest === null) return null;
  const rows = ranked(
    moves.filter(({ scored }) => Math.abs(scored.distance) === distance),
    by,
  );
  const names = changedIn(rows);
  const taken = moves.find(({ id }) => id === changes.best.variables);
  return (
    <Card title="Moves by hand, ranked" note={String(rows.length)}>
      <Group gap="md" align="end">
        <NativeSelect
          label="Best by"
          data={OPTIONS}
          value={by}
          onChange={({ currentTarget }) => setBy(currentTarget.value as Figure)}
          maw={220}
        />
        {distances.length > 1 && (
          <NativeSelect
            label="Of moves by"
            data={distances.map((one) => ({ value: String(one), label: `${compact(one, 6)} µsteps` }))}
            value={distance}
            onChange={({ currentTarget }) => setChosen(Number(currentTarget.value))}
            maw={220}
          />
        )}
      </Group>
      {rows.length > 1 && names.length > 0 && (
        <Together trials={pointsOf(rows, by)} label="Settings that were changed, and the figure of each move" />
      )}
      <Table.ScrollContainer minWidth={480} type="native">
        <Table mt="xs" withRowBorders={false} verticalSpacing={2} aria-label="Moves by hand, the best first">
          <Table.Thead>
            <Table.Tr>
              <Table.Th scope="col">Move</Table.Th>
              {SHOWN.map((figure) => (
                <Table.Th key={figure} scope="col">
                  {titleOf(figure)}
                </Table.Th>
              ))}
              {names.map((name) => (
                <Table.Th key={name} scope="col">
                  {name}
                </Table.Th>
              ))}
              <Table.Th scope="col" />
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {rows.map((move) => (
              <Table.Tr key={move.id} data-testid="move">
                <Table.Th scope="row">{dateTimeOf(move.started_unix_s * 1000)}</Table.Th>
                {SHOWN.map((figure) => (
                  <Table.Td key={figure} className="num">
                    {(figure === "time_s" && endedBy(move)) || compact(move.scored[figure], 3)}
                  </Table.Td>
                ))}
                {names.map((name) => (
                  <Table.Td key={name} className="num">
                    {compact(move.setting[name] ?? null, 6)}
                  </Table.Td>
                ))}
                <Table.Td>
                  <Button size="compact-sm" variant="default" disabled={busy} onClick={() => setAsked(move.id)}>
                    Take…
                  </Button>
                </Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      </Table.ScrollContainer>
      {moves
        .filter(({ id }) => id === asked)
        .map((move) => (
          <Preview
            key={move.id}
            move={move}
            latest={latest}
            loading={changes.best.isPending}
            onTake={() => changes.best.mutate(move.id, { onSuccess: () => setAsked(null) })}
            onCancel={() => setAsked(null)}
          />
        ))}
      {taken && changes.best.isSuccess && changes.undo.variables !== taken.id && (
        <Group gap="xs" mt="xs" role="status">
          <Text size="sm">Set as in that move.</Text>
          <Button
            size="compact-sm"
            variant="default"
            loading={changes.undo.isPending}
            disabled={busy}
            onClick={() => changes.undo.mutate(taken.id)}
          >
            Undo
          </Button>
        </Group>
      )}
      <ProblemAlert error={changes.best.error} doing="Taking the setting" onClose={() => changes.best.reset()} />
    </Card>
  );
}

interface PreviewProps {
  move: Move;
  latest: Move;
  loading: boolean;
  onTake: () => void;
  onCancel: () => void;
}

/** What taking a move's setting changes, against the latest move: before it is done. */
function Preview({ move, latest, loading, onTake, onCancel }: PreviewProps) {
  const changed = differences(move, latest);
  return (
    <section aria-label="What taking it sets" className={classes.preview}>
      <Text size="sm">
        {changed.length === 0
          ? "As in the latest move; what was changed since then goes back."
          : "Against the latest move:"}
      </Text>
      <ul className="list">
        {changed.map(([name, from, to]) => (
          <li key={name} className="num text-13">
            {name}: {compact(from, 6)} → {compact(to, 6)}
          </li>
        ))}
      </ul>
      <Group gap="xs" mt={4}>
        <Button size="compact-sm" loading={loading} onClick={onTake}>
          Take it
        </Button>
        <Button size="compact-sm" variant="default" onClick={onCancel}>
          Leave it
        </Button>
      </Group>
    </section>
  );
}
