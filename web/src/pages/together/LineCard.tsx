import { Button, Group, Table, Text } from "@mantine/core";
import { IconLine, IconPlayerStop } from "@tabler/icons-react";
import { useMemo } from "react";
import { Card } from "../../lib/Card";
import { compact, duration, fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { colorOf } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { useWork } from "../../lib/useWork";
import { Plot } from "../../plots/Plot";
import { type LinePlan, lineText, type StraightLine } from "./starts";
import classes from "./together.module.css";
import { planLine, startLine, stopLine, useLine } from "./useTogether";

interface Props {
  /** null while the chosen axes and targets make none */
  line: StraightLine | null;
  names: Readonly<Record<string, string>>;
  pace: number;
  onPace: (percent: number) => void;
}

/** The chosen axes go to their targets on a straight line and arrive together: planned first, then gone. */
export function LineCard({ line, names, pace, onPace }: Props) {
  const plan = useWork(() => (line === null ? Promise.reject(new Error("choose axes first")) : planLine(line)));
  const start = useWork(() => (line === null ? Promise.reject(new Error("choose axes first")) : startLine(line)));
  const stop = useWork(stopLine);
  const state = useLine();
  const running = state.data?.state === "running";
  return (
    <Card title="Straight line" note="all arrive together, at positions">
      <Group gap="md" align="end">
        <NumberField
          size="xs"
          label="Pace"
          className={classes.pace ?? ""}
          unit="%"
          value={pace}
          min={1}
          max={100}
          step={5}
          onChange={onPace}
        />
        <Button size="sm" variant="default" disabled={line === null} loading={plan.isPending} onClick={plan.mutate}>
          Plan
        </Button>
        <Button
          size="sm"
          leftSection={<IconLine size={16} aria-hidden />}
          disabled={line === null || running}
          loading={start.isPending}
          onClick={start.mutate}
        >
          Go there
        </Button>
        {running && (
          <Button size="sm" color="red" leftSection={<IconPlayerStop size={16} aria-hidden />} onClick={stop.mutate}>
            Stop
          </Button>
        )}
        <Text size="xs" c="dimmed" role="status" data-testid="line-state">
          {line === null ? "Choose axes above, each with a position." : lineText(state.data)}
        </Text>
      </Group>
      <div className="mt-8">
        <ProblemAlert error={plan.error} doing="Planning the line" onClose={() => plan.reset()} />
        <ProblemAlert error={start.error} doing="Going on the line" onClose={() => start.reset()} />
        <ProblemAlert error={stop.error} doing="Stopping" onClose={() => stop.reset()} />
      </div>
      {plan.data !== undefined && <Plan plan={plan.data} names={names} />}
    </Card>
  );
}

const HUES = ["position", "velocity", "acceleration", "encoder_position", "load_value", "residual"];

function Plan({ plan, names }: { plan: LinePlan; names: Props["names"] }) {
  const scheme = useScheme();
  const leg = plan.legs[0];
  const title = ({ device, axis }: { device: string; axis: number }) => `${names[device] ?? device} ${axis}`;
  const data = useMemo(
    () => (leg === undefined ? undefined : ([leg.time_s, ...leg.axes.map(({ position }) => position)] as const)),
    [leg],
  );
  if (leg === undefined || data === undefined) return null;
  return (
    <div data-testid="line-plan">
      <Plot
        label="Expected positions over time"
        summary={`All are there after ${duration(leg.duration_s)}, ${duration(leg.arrival_spread_s)} apart`}
        series={leg.axes.map((axis, index) => ({
          label: title(axis),
          color: colorOf(HUES[index % HUES.length] ?? "position", scheme),
          unit: "µsteps",
        }))}
        data={data}
        height={200}
        x={{ label: "time", unit: "s" }}
        legend
      />
      <Table className={classes.table} verticalSpacing={4} mt="xs">
        <Table.Thead>
          <Table.Tr>
            <Table.Th>Axis</Table.Th>
            <Table.Th className="right">Speed</Table.Th>
            <Table.Th className="right">There after</Table.Th>
            <Table.Th className="right">Off the line</Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {leg.axes.map((axis) => (
            <Table.Tr key={`${axis.device}/${axis.axis}`}>
              <Table.Td>{title(axis)}</Table.Td>
              <Table.Td className="right">{fixed(axis.velocity_pps)} pps</Table.Td>
              <Table.Td className="right">{duration(axis.duration_s)}</Table.Td>
              <Table.Td className="right">{compact(axis.off_line, 2)} µsteps</Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </div>
  );
}
