import { Button, Checkbox, Group, Text } from "@mantine/core";
import { useState } from "react";
import { motion } from "../../../api/motion";
import type { Device } from "../../../api/queries";
import { NumberField } from "../../../lib/NumberField";
import { type Entry, entryIn, fromSteps, type PositionUnit, scaleOf } from "../../../lib/units";
import type { Action } from "./useAction";

interface Props {
  device: Device;
  unit: string;
  action: Action;
  disabled: boolean;
}

const NOWHERE: Entry = { value: 0, unit: "microsteps" };

/** All axes of a device, started together: their targets go out in successive datagrams. */
export function TogetherSection({ device, unit, action, disabled }: Props) {
  const [targets, setTargets] = useState<Record<number, Entry>>({});
  const [wrong, setWrong] = useState<Record<number, boolean>>({});
  const [left, setLeft] = useState<readonly number[]>([]);
  const taking = device.axes.filter((axis) => !left.includes(axis.index));
  return (
    <>
      {device.axes.map((axis) => {
        const scale = scaleOf(axis, device.clock_hz);
        const own = Number.isNaN(fromSteps(1, unit, scale, "position")) ? "microsteps" : unit;
        const out = left.includes(axis.index);
        return (
          <Group key={axis.index} gap={8} wrap="nowrap">
            <Checkbox
              w={52}
              label={axis.name}
              checked={!out}
              disabled={disabled}
              onChange={() => setLeft(out ? left.filter((index) => index !== axis.index) : [...left, axis.index])}
            />
            <NumberField
              aria-label={`Target of ${axis.name}`}
              value={entryIn(targets[axis.index] ?? NOWHERE, own, scale, "position")}
              unit={own}
              flex={1}
              disabled={disabled || out}
              onChange={(value) => setTargets({ ...targets, [axis.index]: { value, unit: own } })}
              onWrong={(refused) => setWrong((old) => ({ ...old, [axis.index]: refused }))}
            />
          </Group>
        );
      })}
      <Group justify="space-between" wrap="nowrap">
        <Text size="xs" c="dimmed">
          Absolute targets
        </Text>
        <Button
          disabled={disabled || taking.length === 0 || taking.some(({ index }) => wrong[index])}
          data-testid="move-together"
          onClick={() =>
            void action.run("Moving together", () =>
              motion.moveTogether(
                device.id,
                taking.map((axis) => {
                  const { value, unit: typedIn } = targets[axis.index] ?? NOWHERE;
                  return {
                    axis: axis.index,
                    target: value,
                    relative: false,
                    unit: typedIn as NonNullable<PositionUnit>,
                  };
                }),
              ),
            )
          }
        >
          Start {taking.length} {taking.length === 1 ? "axis" : "together"}
        </Button>
      </Group>
    </>
  );
}
