import { ActionIcon, Button, Group, Text } from "@mantine/core";
import { useLocalStorage } from "@mantine/hooks";
import { IconPlayerPlayFilled, IconPlayerStop, IconX } from "@tabler/icons-react";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { Link } from "wouter";
import { api } from "../../api/client";
import { type Device, useDevices } from "../../api/queries";
import { Card } from "../../lib/Card";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useSelection } from "../../live/selection";
import classes from "./bench.module.css";
import { endDemo, startDemo } from "./demo";
import { shuttleKey } from "./motion/ShuttleSection";
import { useAction } from "./motion/useAction";
import { TryModels } from "./TryModels";

const NEXT: readonly (readonly [href: string, name: string, what: string])[] = [
  ["/ramps", "Ramps", "design one and send it"],
  ["/registers", "Registers", "live, bit by bit"],
  ["/first-run", "First run", "step by step"],
  ["/connections", "Connections", ""],
];

/** For a user who sees stepscope for the first time: one click to motion, then where to go. */
export function DemoBanner({ devices }: { devices: readonly Device[] }) {
  const demo = devices.filter((device) => device.demo && device.state === "connected");
  const [hidden, setHidden] = useLocalStorage({ key: "stepscope.demo-hidden", defaultValue: false });
  const queries = useQueryClient();
  const selection = useSelection();
  const action = useAction();
  const lost = useDevices().isError;
  const axes = demo.flatMap((device) => device.axes.map((axis) => ({ device: device.id, axis: axis.index })));
  const shuttles = useQuery({
    queryKey: ["shuttle", "demo"],
    queryFn: async () => {
      const asked = axes.map(async (at) => {
        const shuttle = await api.GET("/api/v1/devices/{device}/axes/{axis}/shuttle", { path: at });
        queries.setQueryData(shuttleKey(at), shuttle);
        return shuttle.running;
      });
      const answers = await Promise.allSettled(asked);
      return { running: answers.some((answer) => answer.status === "fulfilled" && answer.value) };
    },
    refetchInterval: 2000,
    enabled: !hidden && demo.length > 0,
  });
  if (hidden || demo.length === 0) return null;
  const running = shuttles.data?.running === true;
  const refresh = () => void queries.invalidateQueries({ queryKey: ["shuttle"] });
  const start = () => {
    const [first] = demo;
    // what moves is what is shown: on a phone nothing else tells that anything does
    if (first && !demo.some((device) => device.id === selection.device?.id)) selection.select(first.id, 0);
    return startDemo(demo);
  };
  return (
    <Card className={`${classes.demo} mid pad-s lines-12`} aria-label="Demo" data-running={running}>
      <Button
        variant={running ? "default" : "filled"}
        leftSection={
          running ? <IconPlayerStop size={16} aria-hidden /> : <IconPlayerPlayFilled size={16} aria-hidden />
        }
        loading={action.busy}
        disabled={lost}
        data-testid="demo-motion"
        onClick={() =>
          void action
            .run(running ? "Ending the demo" : "Starting the demo", () => (running ? endDemo(demo) : start()))
            .then(refresh)
        }
      >
        {running ? "End demo motion" : "Start demo motion"}
      </Button>
      {running ? (
        <Group gap={14} className={classes.next} wrap="nowrap">
          <Text size="sm" c="dimmed">
            Next:
          </Text>
          {NEXT.map(([href, name, what]) => (
            <Text key={href} size="sm">
              <Link href={href} className="accent bold">
                {name}
              </Link>{" "}
              <Text span size="sm" c="dimmed" visibleFrom="xl">
                {what}
              </Text>
            </Text>
          ))}
        </Group>
      ) : (
        <Group gap={14} className={classes.next} wrap="nowrap">
          <Text size="sm" truncate className={classes.ready}>
            {axes.length} emulated axes are ready: nothing can break.
          </Text>
          <TryModels devices={devices} />
        </Group>
      )}
      <ActionIcon aria-label="Hide the demo bar" onClick={() => setHidden(true)} className="push">
        <IconX size={16} />
      </ActionIcon>
      {action.failure && (
        <ProblemAlert error={action.failure.error} doing={action.failure.doing} onClose={action.dismiss} />
      )}
    </Card>
  );
}
