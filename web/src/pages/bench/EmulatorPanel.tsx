import { CloseButton, Group, Stack, Title } from "@mantine/core";
import type { Device } from "../../api/queries";
import { familyOf } from "../../families/families";
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

/** The world behind an emulated device's pins, to be played with. */
export function EmulatorPanel({ device, axis, onAxis, onClose }: Props) {
  const emulator = useEmulator(device, true);
  const change = useChangeEmulator(device.id);
  const state = emulator.data;
  const Controls = familyOf(device)?.Controls;
  const problem = change.error ?? emulator.error;
  return (
    <aside className={`${classes.emulator} card`} aria-label={`Emulator of ${device.name}`} data-testid="emulator">
      <Group justify="space-between" wrap="nowrap" mb={4}>
        <Title order={2} className="clip text-14">
          Emulator of {device.name}
        </Title>
        <CloseButton size="sm" aria-label="Close the emulator panel" onClick={onClose} />
      </Group>
      <Stack gap="sm">
        {problem && <ProblemAlert error={problem} doing="Changing the emulator" onClose={change.reset} />}
        {state && Controls && (
          <Controls device={device} state={state} axis={axis} onAxis={onAxis} send={change.mutate} />
        )}
      </Stack>
    </aside>
  );
}
