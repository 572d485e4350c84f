import { ActionIcon, Button, Group } from "@mantine/core";
import { IconMinus, IconPlus } from "@tabler/icons-react";
import { useState } from "react";
import { type AxisAddress, motion } from "../../../api/motion";
import { NumberField } from "../../../lib/NumberField";
import { type AxisScale, type Entry, entryIn, type PositionUnit } from "../../../lib/units";
import classes from "../bench.module.css";
import type { Action } from "./useAction";

interface Props {
  at: AxisAddress;
  scale: AxisScale;
  unit: string;
  action: Action;
  disabled: boolean;
}

/** To a position, or by a distance. */
export function MoveSection({ at, scale, unit, action, disabled }: Props) {
  // kept as typed: another unit of the card shows the same place, and what goes out is the entry itself
  const [turn] = useState<Entry>(() =>
    scale.microstepsPerFullStep === null ? { value: 1000, unit: "microsteps" } : { value: 1, unit: "rev" },
  );
  // a turn from zero, where a new device stands: the first click moves it
  const [target, setTarget] = useState(turn);
  const [distance, setDistance] = useState(turn);
  const [wrong, setWrong] = useState({ target: false, distance: false });
  const go = ({ value, unit: typedIn }: Entry, relative: boolean) =>
    void action.run("Moving", () =>
      motion.move(at, { target: value, relative, unit: typedIn as NonNullable<PositionUnit> }),
    );
  const by = (sign: 1 | -1) => go({ ...distance, value: sign * distance.value }, true);
  const step = unit === "microsteps" ? 100 : unit === "deg" ? 10 : 1;
  const still = disabled || wrong.distance;
  return (
    <>
      <Group gap={6} wrap="nowrap" align="flex-start">
        <NumberField
          classNames={{ root: classes.inline, input: "num" }}
          label="Move to"
          value={entryIn(target, unit, scale, "position")}
          unit={unit}
          step={step}
          flex={1}
          disabled={disabled}
          data-testid="move-target"
          title="Enter goes there"
          onChange={(value) => setTarget({ value, unit })}
          onEnter={(value) => go(value === entryIn(target, unit, scale, "position") ? target : { value, unit }, false)}
          onWrong={(refused) => setWrong((old) => ({ ...old, target: refused }))}
        />
        <Button w={76} disabled={disabled || wrong.target} onClick={() => go(target, false)} data-testid="move-go">
          Go
        </Button>
      </Group>
      <Group gap={6} wrap="nowrap" align="flex-start">
        <NumberField
          classNames={{ root: classes.inline, input: "num" }}
          label="Move by"
          value={entryIn(distance, unit, scale, "position")}
          unit={unit}
          step={step}
          min={0}
          flex={1}
          disabled={disabled}
          onChange={(value) => setDistance({ value, unit })}
          onWrong={(refused) => setWrong((old) => ({ ...old, distance: refused }))}
        />
        <ActionIcon
          size={30}
          w={35}
          variant="default"
          aria-label="Move back by this distance"
          disabled={still}
          onClick={() => by(-1)}
        >
          <IconMinus size={16} />
        </ActionIcon>
        <ActionIcon
          size={30}
          w={35}
          variant="default"
          aria-label="Move forward by this distance"
          disabled={still}
          onClick={() => by(1)}
        >
          <IconPlus size={16} />
        </ActionIcon>
      </Group>
    </>
  );
}
