import { CloseButton, Group, Stack, Title } from "@mantine/core";
import type { Device } from "../../api/queries";
import { ProblemAlert } from "../../lib/ProblemAlert";
import classes from "./bench.module.css";
import { ChipControls } from "./ChipControls";
import { ModuleControls } from "./ModuleControls";
import { Tmc5xxxControls } from "./Tmc5xxxControls";
import { Tmc4361Controls } from "./Tmc4361Controls";
import { isModuleState, isTmc5xxxState, isTmc4361State, useChangeEmulator, useEmulator } from "./useEmulator";

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
  const problem = change.error ?? emulator.error;
  return (
    <aside className={classes.emulator} aria-label={`Emulator of ${device.name}`} data-testid="emulator">
      <Group justify="space-between" wrap="nowrap" mb={4}>
        <Title order={2} className={classes.cardTitle}>
          Emulator of {device.name}
        </Title>
        <CloseButton size="sm" aria-label="Close the emulator panel" onClick={onClose} />
      </Group>
      <Stack gap="sm">
        {problem && <ProblemAlert error={problem} doing="Changing the emulator" onClose={change.reset} />}
        {state &&
          (isModuleState(state) ? (
            <ModuleControls state={state} send={change.mutate} />
          ) : isTmc4361State(state) ? (
            <Tmc4361Controls state={state} send={change.mutate} />
          ) : isTmc5xxxState(state) ? (
            <Tmc5xxxControls device={device} state={state} axis={axis} onAxis={onAxis} send={change.mutate} />
          ) : (
            <ChipControls device={device} state={state} send={change.mutate} />
          ))}
      </Stack>
    </aside>
  );
}
