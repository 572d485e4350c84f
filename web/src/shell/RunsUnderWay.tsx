import { Alert, Button, Group, Text } from "@mantine/core";
import { IconAlertTriangle, IconRotateClockwise } from "@tabler/icons-react";
import { useSyncExternalStore } from "react";
import { Link, useLocation } from "wouter";
import { useDevices } from "../api/queries";
import { PAGES } from "./pages";
import { runsUnderWay, watchRuns } from "./runs";

/** On every other page than its own: a sweep or slow turn that goes on, or ended by itself, with the ways to it and out. */
export function RunsUnderWay() {
  const runs = useSyncExternalStore(watchRuns, runsUnderWay);
  const devices = useDevices();
  const [location] = useLocation();
  return runs
    .filter(({ page }) => page !== location)
    .map(({ at, run, page, untold, seen }) => {
      const device = devices.data?.find(({ id }) => id === at.device);
      const name = `${device?.name ?? at.device} ${device?.axes[at.axis]?.name ?? at.axis}`;
      const state = run.state;
      const ended = untold();
      const toIt = (
        <Button size="compact-sm" variant="default" component={Link} href={page}>
          {PAGES.find(({ path }) => path === page)?.label ?? "Back to it"}
        </Button>
      );
      if (ended !== null)
        return (
          <Alert
            key={`${at.device}/${at.axis}`}
            color="yellow"
            role="alert"
            p="xs"
            mb="sm"
            icon={<IconAlertTriangle size={20} aria-hidden />}
            data-testid="run-ended"
          >
            <Group gap="sm" justify="space-between">
              <Text size="sm">
                {name} no longer turns as begun. {ended}
              </Text>
              <Group gap="xs">
                {toIt}
                <Button size="compact-sm" variant="default" onClick={seen}>
                  Close
                </Button>
              </Group>
            </Group>
          </Alert>
        );
      return (
        <Alert
          key={`${at.device}/${at.axis}`}
          color="blue"
          role="status"
          p="xs"
          mb="sm"
          icon={<IconRotateClockwise size={20} aria-hidden />}
          data-testid="run-under-way"
        >
          <Group gap="sm" justify="space-between">
            <Text size="sm">
              {name} still turns
              {state.phase === "running" && `, part ${state.leg + 1} of ${state.legs}`}.
            </Text>
            <Group gap="xs">
              {toIt}
              <Button size="compact-sm" color="red" onClick={() => run.abort()}>
                Stop
              </Button>
            </Group>
          </Group>
        </Alert>
      );
    });
}
