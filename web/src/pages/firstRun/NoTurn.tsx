import { Alert, List } from "@mantine/core";
import { useEffect } from "react";
import { api } from "../../api/client";
import type { Device } from "../../api/queries";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useWork } from "../../lib/useWork";
import { whyNoTurn } from "./noTurn";
import { turnsBy } from "./steps";
import { turn } from "./turning";

const LOOKS = 15;
const LOOK_MS = 100;

interface Props {
  device: Device;
  axis: number;
}

/** What the driver tells of the coils while the motor is told to turn once more. */
export function NoTurn({ device, axis }: Props) {
  const at = { device: device.id, axis };
  const look = useWork(async () => {
    if (turnsBy(device) !== "steps from outside") await turn(at, device, 1);
    const seen = [];
    for (let each = 0; each < LOOKS; each += 1) {
      seen.push(await api.GET("/api/v1/devices/{device}/axes/{axis}", { path: at }));
      await new Promise((resolve) => setTimeout(resolve, LOOK_MS));
    }
    return whyNoTurn(seen);
  });
  // biome-ignore lint/correctness/useExhaustiveDependencies: once, as it was asked for
  useEffect(() => look.mutate(), []);
  if (look.error) return <ProblemAlert error={look.error} doing="Looking at the coils" retry={look.mutate} />;
  if (look.data === undefined)
    return (
      <p className="hint m-0" role="status">
        The motor is told to turn once more, and its driver is asked what it sees
      </p>
    );
  return (
    <Alert color="yellow" mt="xs" data-testid="no-turn">
      <b>It did not turn:</b> {look.data.found}
      {look.data.help.length > 0 && (
        <List size="sm" mt={4}>
          {look.data.help.map((each) => (
            <List.Item key={each}>{each}</List.Item>
          ))}
        </List>
      )}
    </Alert>
  );
}
