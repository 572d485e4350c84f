import { Button, type ButtonProps } from "@mantine/core";
import { startUpWanted } from "./wanted";

interface Props extends Pick<ButtonProps, "size" | "variant" | "disabled"> {
  device: string;
  axes: readonly number[] | null;
  axisNames?: readonly string[];
  label?: string;
  onDone?: (() => void) | undefined;
}

/** Opens the start-up of a device or of some of its axes, which shows first what it would write. */
export function StartUpButton({ device, axes, axisNames = [], label = "Start up", onDone, ...look }: Props) {
  return (
    <Button
      size="sm"
      {...look}
      data-testid="start-up-open"
      onClick={() => startUpWanted.set({ device, axes, axisNames, onDone })}
    >
      {label}…
    </Button>
  );
}
