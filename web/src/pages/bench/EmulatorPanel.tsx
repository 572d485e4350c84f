import { CloseButton, Stack } from "@mantine/core";
import type { Device } from "../../api/queries";
import { familyOf } from "../../families/families";
import { Card } from "../../lib/Card";
import { ProblemAlert } from "../../lib/ProblemAlert";
import classes from "./bench.module.css";
import { useChangeEmulator, useEmulator } from "./useEmulator";

interface Props {
  device: Device;
  /** whose motor is shown, where a chip has several */
  axis: number;
  onAxis: (axis: number) => void;
  onClose: () => void;
}

/** The plant of an emulated device, and what is at its pins, to be played with. */
export function EmulatorPanel({ device, axis, onAxis, onClose }: Props) {
  const emulator = useEmulator(device, true);
  const change = useChangeEmulator(device.id);
  const state = emulator.data;
  const Controls = familyOf(device)?.Controls;
  const problem = change.error ?? emulator.error;
  return (
    <Card
      as="aside"
      title={`Emulator of ${device.name}`}
      actions={<CloseButton size="sm" aria-label="Close the emulator panel" onClick={onClose} />}
      className={classes.emulator}
      data-testid="emulator"
    >
      <Stack gap="sm">
        {problem && <ProblemAlert error={problem} doing="Changing the emulator" onClose={change.reset} />}
        {state && Controls && (
          <Controls device={device} state={state} axis={axis} onAxis={onAxis} send={change.mutate} />
        )}
      </Stack>
    </Card>
  );
}
