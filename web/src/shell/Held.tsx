import { Alert, Button, Group, Text } from "@mantine/core";
import { IconPlayerPause } from "@tabler/icons-react";
import { Link } from "wouter";
import type { Device } from "../api/queries";
import { sentence } from "../lib/condition/kinds";
import { RemedyButton } from "../lib/condition/RemedyButton";
import { useRemedies } from "../lib/condition/remedy";
import { ProblemAlert } from "../lib/ProblemAlert";
import { useStanding } from "../live/useStanding";

/** A device that is left alone, why, and the way out. */
export function Held({ device }: { device: Device }) {
  const remedies = useRemedies();
  const { condition } = useStanding(device.id, 0);
  return (
    <Alert
      color="orange"
      role="alert"
      p="sm"
      mb="sm"
      icon={<IconPlayerPause size={20} aria-hidden />}
      styles={{ label: { color: "var(--mantine-color-text)" } }} // the orange of the library is too faint on its light ground
      title={`${device.name}: ${device.problem?.title ?? ""}`}
      data-testid="held-back"
    >
      <Text size="sm">{device.problem?.detail}</Text>
      <Group mt="xs" gap="sm">
        {condition.remedies.map((remedy) => (
          <RemedyButton key={remedy.label} remedy={remedy} remedies={remedies} main />
        ))}
        <Button size="compact-sm" variant="default" component={Link} href="/connections">
          Connections
        </Button>
      </Group>
      {remedies.isError && <ProblemAlert error={remedies.error} doing={sentence(remedies.variables.label)} />}
    </Alert>
  );
}
