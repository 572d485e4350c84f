import { ActionIcon, Button, Group, Table, Text } from "@mantine/core";
import { IconLine, IconMapPinPlus, IconPlayerStop, IconX } from "@tabler/icons-react";
import { useQueryClient } from "@tanstack/react-query";
import { useMemo, useState } from "react";
import { Card } from "../../lib/Card";
import { compact, duration, fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { colorOf } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { useWork } from "../../lib/useWork";
import { Plot } from "../../plots/Plot";
import {
  beside,
  type LinePath,
  type LinePlan,
  type LineWish,
  lineText,
  type Row,
  type StraightLine,
  seenText,
  titleIn,
  viaOf,
  withoutVia,
  withVia,
} from "./starts";
import classes from "./together.module.css";
import { LINE_KEY, planLine, startLine, stopLine, useLine, useLinePath } from "./useTogether";

interface Props {
  /** null while the chosen axes and targets make none */
  line: StraightLine | null;
  rows: readonly Row[];
  wish: LineWish;
  onWish: (wish: LineWish) => void;
}

/** The chosen axes go to their targets on a straight line and arrive together: planned first, then gone. */
export function LineCard({ line, rows, wish, onWish }: Props) {
  const queries = useQueryClient();
  const [shown, show] = useState<"plan" | "gone">("gone");
  const plan = useWork(() => (line === null ? Promise.reject(new Error("choose axes first")) : planLine(line)), {
    onSuccess: () => show("plan"),
  });
  const start = useWork(() => (line === null ? Promise.reject(new Error("choose axes first")) : startLine(line)), {
    onSuccess: () => {
      show("gone");
      return queries.invalidateQueries({ queryKey: LINE_KEY });
    },
  });
  const stop = useWork(stopLine);
  const state = useLine();
  const path = useLinePath(state.data);
  const running = state.data?.state === "running";
  return (
    <Card title="Straight line" note="all arrive together, at positions">
      <Group gap="md" align="end">
        <NumberField
          size="xs"
          label="Pace"
          className={classes.pace ?? ""}
          unit="%"
          value={wish.pacePercent}
          min={1}
          max={100}
          step={5}
          onChange={(pacePercent) => onWish({ ...wish, pacePercent })}
        />
        <NumberField
          size="xs"
          label="Each leg takes"
          className={classes.pace ?? ""}
          unit="s"
          placeholder="by pace"
          value={wish.legS}
          min={0.01}
          max={3600}
          step={0.5}
          onChange={(legS) => onWish({ ...wish, legS })}
          onClear={() => onWish({ ...wish, legS: null })}
        />
        <Button
          variant="default"
          leftSection={<IconMapPinPlus size={16} aria-hidden />}
          disabled={line === null || line.points.length >= POINTS_MAX}
          onClick={() => line !== null && onWish(withVia(line, wish))}
        >
          Go by these positions
        </Button>
        <Button variant="default" disabled={line === null} loading={plan.isPending} onClick={plan.mutate}>
          Plan
        </Button>
        <Button
          leftSection={<IconLine size={16} aria-hidden />}
          disabled={line === null || running}
          loading={start.isPending}
          onClick={start.mutate}
        >
          Go there
        </Button>
        {running && (
          <Button color="red" leftSection={<IconPlayerStop size={16} aria-hidden />} onClick={stop.mutate}>
            Stop
          </Button>
        )}
        <Text size="xs" c="dimmed" role="status" data-testid="line-state">
          {line === null ? "Choose axes above, each with a position." : lineText(state.data)}
        </Text>
      </Group>
      {line !== null && <Via line={line} rows={rows} wish={wish} onWish={onWish} />}
      <div className="mt-8">
        <ProblemAlert error={plan.error} doing="Planning the line" onClose={() => plan.reset()} />
        <ProblemAlert error={start.error} doing="Going on the line" onClose={() => start.reset()} />
        <ProblemAlert error={stop.error} doing="Stopping" onClose={() => stop.reset()} />
      </div>
      {shown === "plan" && plan.data !== undefined && <Plan plan={plan.data} rows={rows} />}
      {shown === "gone" && path.data?.plan && <Plan plan={path.data.plan} path={path.data} rows={rows} />}
    </Card>
  );
}

/** As many as the server takes. */
const POINTS_MAX = 64;

/** The points on the way, in their order. */
function Via({ line, rows, wish, onWish }: Props & { line: StraightLine }) {
  const points = viaOf(line.axes, wish);
  if (points.length === 0) return null;
  return (
    <Table className={classes.table} maw={560} mt="xs" verticalSpacing={3} data-testid="via">
      <Table.Thead>
        <Table.Tr>
          <Table.Th>By</Table.Th>
          {line.axes.map(({ device, axis }) => (
            <Table.Th key={`${device}/${axis}`} className="right">
              {titleIn(rows, { device, axis })}
            </Table.Th>
          ))}
          <Table.Th aria-label="Remove" />
        </Table.Tr>
      </Table.Thead>
      <Table.Tbody>
        {points.map((point, number) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: a point is its place on the way, and may come twice
          <Table.Tr key={number}>
            <Table.Td>{number + 1}</Table.Td>
            {line.axes.map(({ device, axis }, index) => (
              <Table.Td key={`${device}/${axis}`} className="right">
                {fixed(point[index] ?? 0)}
              </Table.Td>
            ))}
            <Table.Td className="right">
              <ActionIcon
                size="sm"
                variant="subtle"
                aria-label={`Remove point ${number + 1}`}
                onClick={() => onWish(withoutVia(wish, number))}
              >
                <IconX size={14} aria-hidden />
              </ActionIcon>
            </Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}

const HUES = ["position", "velocity", "acceleration", "encoder_position", "load_value", "residual"];

interface PlanProps {
  plan: LinePlan;
  /** where the axes were seen when it was gone */
  path?: LinePath;
  rows: Props["rows"];
}

/** Expected positions as lines, those seen as dots at their own times, and each axis of each leg in figures. */
function Plan({ plan, path, rows }: PlanProps) {
  const scheme = useScheme();
  const last = plan.legs.at(-1);
  const several = plan.legs.length > 1;
  const title = (axis: Pick<Row, "device" | "axis">) => titleIn(rows, axis);
  const data = useMemo(() => {
    const { timeS, expected, measured } = beside(plan, path);
    return [timeS, ...expected, ...(path === undefined ? [] : measured)] as const;
  }, [plan, path]);
  const seen = (leg: number, device: string, axis: number) =>
    path?.legs[leg]?.axes.find((one) => one.device === device && one.axis === axis);
  const hue = (index: number) => colorOf(HUES[index % HUES.length] ?? "position", scheme);
  if (last === undefined) return null;
  return (
    <div data-testid="line-plan">
      <Plot
        label={path === undefined ? "Expected positions over time" : "Expected and measured positions over time"}
        summary={`All are there after ${duration(plan.duration_s)}, ${duration(last.arrival_spread_s)} apart`}
        series={[
          ...last.axes.map((axis, index) => ({ label: title(axis), color: hue(index), unit: "µsteps" })),
          ...(path === undefined ? [] : last.axes).map((axis, index) => ({
            label: `${title(axis)} measured`,
            color: hue(index),
            unit: "µsteps",
            dots: 4,
            line: false,
          })),
        ]}
        data={data}
        height={200}
        x={{ label: "time", unit: "s" }}
        legend
      />
      <Table className={classes.table} verticalSpacing={4} mt="xs">
        <Table.Thead>
          <Table.Tr>
            {several && <Table.Th>Leg</Table.Th>}
            <Table.Th>Axis</Table.Th>
            <Table.Th className="right">Speed</Table.Th>
            <Table.Th className="right">There after</Table.Th>
            <Table.Th className="right">Off the line</Table.Th>
            {path !== undefined && <Table.Th className="right">Seen off it</Table.Th>}
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {plan.legs.map((leg, number) =>
            leg.axes.map((axis) => (
              // biome-ignore lint/suspicious/noArrayIndexKey: a leg is its place on the way
              <Table.Tr key={`${number} ${axis.device}/${axis.axis}`}>
                {several && <Table.Td>{number + 1}</Table.Td>}
                <Table.Td>
                  {title(axis)}
                  {axis.warnings.map((warning) => (
                    <Text key={warning} size="xs" className="caution">
                      {warning}
                    </Text>
                  ))}
                </Table.Td>
                <Table.Td className="right">{fixed(axis.velocity_pps, 0, "pps")}</Table.Td>
                <Table.Td className="right">{duration(axis.duration_s)}</Table.Td>
                <Table.Td className="right">{compact(axis.off_line, 2)} µsteps</Table.Td>
                {path !== undefined && (
                  <Table.Td className="right">{seenText(seen(number, axis.device, axis.axis))}</Table.Td>
                )}
              </Table.Tr>
            )),
          )}
        </Table.Tbody>
      </Table>
    </div>
  );
}
