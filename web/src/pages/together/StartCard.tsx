import { Button, Checkbox, Group, SegmentedControl, Table, Text } from "@mantine/core";
import { IconArrowsSplit2, IconPlayerPlay } from "@tabler/icons-react";
import { useState } from "react";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { duration, fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useWork } from "../../lib/useWork";
import { LineCard } from "./LineCard";
import {
  type Choice,
  type Choices,
  lineOf,
  movesOf,
  NO_WISH,
  type Row,
  type StartedTogether,
  skewText,
  titleIn,
  UNSAID,
} from "./starts";
import classes from "./together.module.css";
import { startTogether } from "./useTogether";

interface Props {
  rows: readonly Row[];
}

/** Axes are chosen, get their targets, and start at once; then how far apart they really started is told. */
export function StartCard({ rows }: Props) {
  const [choices, setChoices] = useState<Choices>({});
  const [relative, setRelative] = useState(false);
  const [useWires, setUseWires] = useState(true);
  const [wish, setWish] = useState(NO_WISH);
  const moves = movesOf(rows, choices, relative);
  const start = useWork(() => startTogether(moves ?? [], useWires));
  const change = (key: string, more: Partial<Choice>) =>
    setChoices((all) => ({ ...all, [key]: { ...(all[key] ?? UNSAID), ...more } }));
  if (rows.length === 0)
    return (
      <Card title="Start together">
        <EmptyState title="No axis to start" icon={<IconArrowsSplit2 size={22} />}>
          <Text size="sm">Devices that move a motor and are connected are listed here.</Text>
        </EmptyState>
      </Card>
    );
  return (
    <>
      <Card
        title="Start together"
        note="all are judged first; a stop ends it for all"
        actions={
          <SegmentedControl
            size="xs"
            aria-label="Targets are"
            value={relative ? "by" : "to"}
            onChange={(value) => setRelative(value === "by")}
            data={[
              { value: "to", label: "Positions" },
              { value: "by", label: "Distances" },
            ]}
          />
        }
      >
        <Table className={classes.table} maw={560} verticalSpacing={3} data-testid="together-axes">
          <Table.Thead>
            <Table.Tr>
              <Table.Th>Axis</Table.Th>
              <Table.Th>{relative ? "By" : "To"}</Table.Th>
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {rows.map((row) => {
              const { title } = row;
              const { chosen, target } = choices[row.key] ?? UNSAID;
              return (
                <Table.Tr key={row.key}>
                  <Table.Td>
                    <Checkbox
                      size="xs"
                      label={title}
                      checked={chosen}
                      onChange={(event) => change(row.key, { chosen: event.currentTarget.checked })}
                    />
                  </Table.Td>
                  <Table.Td>
                    <NumberField
                      size="xs"
                      className={classes.target ?? ""}
                      aria-label={`Target of ${title} in microsteps`}
                      unit="µsteps"
                      integer
                      value={target}
                      min={-(2 ** 31)}
                      max={2 ** 31 - 1}
                      step={100}
                      onChange={(value) => change(row.key, { target: value, chosen: true })}
                      onClear={() => change(row.key, { target: null })}
                    />
                  </Table.Td>
                </Table.Tr>
              );
            })}
          </Table.Tbody>
        </Table>
        <Group mt="sm" gap="md">
          <Button
            leftSection={<IconPlayerPlay size={16} aria-hidden />}
            disabled={moves === null}
            loading={start.isPending}
            onClick={start.mutate}
          >
            Start together
          </Button>
          <Checkbox
            size="xs"
            label="By START where it is wired"
            checked={useWires}
            onChange={(event) => setUseWires(event.currentTarget.checked)}
          />
          {moves === null && (
            <Text size="xs" c="dimmed">
              Choose axes, each with a target.
            </Text>
          )}
        </Group>
        <div className="mt-8">
          <ProblemAlert error={start.error} doing="Starting together" onClose={() => start.reset()} />
        </div>
      </Card>
      <LineCard line={lineOf(moves, relative, wish)} rows={rows} wish={wish} onWish={setWish} />
      {start.data !== undefined && <Started start={start.data} rows={rows} />}
    </>
  );
}

function Started({ start, rows }: Props & { start: StartedTogether }) {
  const spread = start.spread_s === 0 ? "0 s" : duration(start.spread_s);
  return (
    <Card title="How they started" note={`${spread} between the first and the last`} data-testid="started">
      <Table className={classes.table} verticalSpacing={4}>
        <Table.Thead>
          <Table.Tr>
            <Table.Th>Axis</Table.Th>
            <Table.Th>By</Table.Th>
            <Table.Th className="right">After the first</Table.Th>
            <Table.Th className="right" visibleFrom="sm">
              From
            </Table.Th>
            <Table.Th className="right" visibleFrom="sm">
              To
            </Table.Th>
            <Table.Th className="right" visibleFrom="sm">
              Expected
            </Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {start.axes.map((axis) => (
            <Table.Tr key={`${axis.device}/${axis.axis}`}>
              <Table.Td>
                {titleIn(rows, axis)}
                {axis.warnings.map((warning) => (
                  <Text key={warning} size="xs" className="caution">
                    {warning}
                  </Text>
                ))}
              </Table.Td>
              <Table.Td>{axis.how}</Table.Td>
              <Table.Td className="right nowrap">{skewText(axis)}</Table.Td>
              <Table.Td className="right" visibleFrom="sm">
                {fixed(axis.from_position)}
              </Table.Td>
              <Table.Td className="right" visibleFrom="sm">
                {fixed(axis.target_position)}
              </Table.Td>
              <Table.Td className="right" visibleFrom="sm">
                {axis.predicted_duration_s === null ? "" : duration(axis.predicted_duration_s)}
              </Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </Card>
  );
}
