import { Button, Group } from "@mantine/core";
import { IconArrowLeft, IconArrowRight, IconPlayerStop, IconRotate, IconRotateClockwise } from "@tabler/icons-react";
import { useState } from "react";
import { type AxisAddress, motion } from "../../../api/motion";
import { exactText, rounded } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { type AxisScale, fromSteps, ratesOf, toSteps } from "../../../lib/units";
import { useLocalKept } from "../../../lib/useKept";
import classes from "../bench.module.css";
import type { Action } from "./useAction";
import { useJog } from "./useJog";

interface Props {
  at: AxisAddress;
  scale: AxisScale;
  unit: string;
  topSpeedPps: number;
  action: Action;
  disabled: boolean;
}

/** By hand: while a button is held, or on and on; and the two ways to stop. */
export function JogSection({ at, scale, unit, topSpeedPps, action, disabled }: Props) {
  const [chosen, setChosen] = useLocalKept<number | null>(`stepscope.jog-pps.${at.device}.${at.axis}`, null);
  const [wrong, setWrong] = useState(false);
  const rate = ratesOf(unit, scale).velocity;
  const speed = chosen ?? topSpeedPps / 4;
  const jog = useJog(at, speed, (error) => action.fail("Jogging", error));
  const rotate = (sign: number) =>
    void action.run("Rotating", () => motion.rotate(at, { velocity: sign * speed, unit: "pps" }));
  const stop = (mode: "ramp" | "immediate") => void action.run("Stopping", () => motion.stop(at, mode));
  return (
    <div className={`${classes.byHand} stack gap-8`}>
      <NumberField
        classNames={{ root: classes.inline, input: "num" }}
        label="Speed"
        value={fromSteps(speed, rate, scale, "velocity")}
        show={(value) => exactText(rounded(value, 5))}
        unit={rate}
        min={0}
        step={rounded(fromSteps(topSpeedPps / 20, rate, scale, "velocity"), 2)}
        disabled={disabled}
        onChange={(value) => setChosen(toSteps(value, rate, scale, "velocity"))}
        onWrong={setWrong}
      />
      <Group grow gap={6} wrap="nowrap">
        <Button
          size="sm"
          variant={jog.direction === -1 ? "filled" : "default"}
          className={classes.jogButton}
          disabled={disabled || wrong}
          aria-label="Jog left: hold"
          title="Hold: moves left; arrow keys work too"
          data-testid="jog-left"
          {...jog.buttonProps(-1)}
        >
          <IconArrowLeft size={20} aria-hidden />
        </Button>
        <Button
          size="sm"
          color="red"
          variant="light"
          className={classes.jogButton}
          leftSection={<IconPlayerStop size={18} aria-hidden />}
          disabled={disabled}
          title="Slow down along the ramp and stop"
          data-testid="stop-axis"
          onClick={() => stop("ramp")}
        >
          Stop
        </Button>
        <Button
          size="sm"
          variant={jog.direction === 1 ? "filled" : "default"}
          className={classes.jogButton}
          disabled={disabled || wrong}
          aria-label="Jog right: hold"
          title="Hold: moves right; arrow keys work too"
          data-testid="jog-right"
          {...jog.buttonProps(1)}
        >
          <IconArrowRight size={20} aria-hidden />
        </Button>
      </Group>
      <Group gap={6} grow wrap="nowrap">
        <Button
          size="compact-xs"
          variant="subtle"
          leftSection={<IconRotate size={14} aria-hidden />}
          disabled={disabled || wrong}
          onClick={() => rotate(-1)}
        >
          Rotate
        </Button>
        <Button
          size="compact-xs"
          variant="subtle"
          color="red"
          disabled={disabled}
          title="Stop dead: steps may be lost"
          onClick={() => stop("immediate")}
        >
          Stop dead
        </Button>
        <Button
          size="compact-xs"
          variant="subtle"
          rightSection={<IconRotateClockwise size={14} aria-hidden />}
          disabled={disabled || wrong}
          onClick={() => rotate(1)}
        >
          Rotate
        </Button>
      </Group>
    </div>
  );
}
