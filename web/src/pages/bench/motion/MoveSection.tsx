import { ActionIcon, Button, Group } from "@mantine/core";
import { IconMinus, IconPlus } from "@tabler/icons-react";
import { useState } from "react";
import { type AxisAddress, motion } from "../../../api/motion";
import { NumberField } from "../../../lib/NumberField";
import { type AxisScale, fromSteps, type PositionUnit, toSteps } from "../../../lib/units";
import classes from "../bench.module.css";
import type { Action } from "./useAction";

interface Props {
  at: AxisAddress;
  scale: AxisScale;
  unit: string;
  action: Action;
  disabled: boolean;
}

function tidy(value: number): number {
  return Number(value.toPrecision(6));
}

/** To a position, or by a distance. */
export function MoveSection({ at, scale, unit, action, disabled }: Props) {
  // kept in microsteps, so that a change of unit does not change where it goes
  const [target, setTarget] = useState(0);
  const [distance, setDistance] = useState(() => {
    const turn = toSteps(1, "rev", scale, "position");
    return Number.isNaN(turn) ? 1000 : turn;
  });
  const shown = (steps: number) => tidy(fromSteps(steps, unit, scale, "position"));
  const go = (value: number, relative: boolean) =>
    action.run("Moving", () => motion.move(at, { target: value, relative, unit: unit as NonNullable<PositionUnit> }));
  const step = unit === "microsteps" ? 100 : unit === "deg" ? 10 : 1;
  return (
    <>
      <Group gap={6} wrap="nowrap" align="flex-start">
        <NumberField
          classNames={{ root: classes.inline, input: "num" }}
          label="Move to"
          value={shown(target)}
          unit={unit}
          step={step}
          flex={1}
          disabled={disabled}
          data-testid="move-target"
          onChange={(value) => setTarget(toSteps(value, unit, scale, "position"))}
        />
        <Button
          size="xs"
          w={76}
          disabled={disabled}
          onClick={() => void go(shown(target), false)}
          data-testid="move-go"
        >
          Go
        </Button>
      </Group>
      <Group gap={6} wrap="nowrap" align="flex-start">
        <NumberField
          classNames={{ root: classes.inline, input: "num" }}
          label="Move by"
          value={shown(distance)}
          unit={unit}
          step={step}
          min={0}
          flex={1}
          disabled={disabled}
          onChange={(value) => setDistance(toSteps(value, unit, scale, "position"))}
        />
        <ActionIcon
          size={30}
          w={35}
          variant="default"
          aria-label="Move back by this distance"
          disabled={disabled}
          onClick={() => void go(-shown(distance), true)}
        >
          <IconMinus size={16} />
        </ActionIcon>
        <ActionIcon
          size={30}
          w={35}
          variant="default"
          aria-label="Move forward by this distance"
          disabled={disabled}
          onClick={() => void go(shown(distance), true)}
        >
          <IconPlus size={16} />
        </ActionIcon>
      </Group>
    </>
  );
}
