import { Button, Group, Text } from "@mantine/core";
import { useState } from "react";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { colorOf } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { useTelemetry } from "../../live/useTelemetry";
import { Plot } from "../../plots/Plot";
import { useAction } from "../bench/motion/useAction";
import { RollingSection } from "../module/RollingSection";
import { useRolling } from "../module/useRolling";
import classes from "./firstRun.module.css";
import type { StepProps } from "./StepProps";
import { turnsBy } from "./steps";
import { turn } from "./turning";

const RATE_HZ = 100;
const QUANTITIES = ["position", "predicted_position", "encoder_position"] as const;
/** Of a device that counts no position. */
const SPEEDS = ["velocity"] as const;
const NAMES = {
  position: "position",
  predicted_position: "predicted",
  encoder_position: "encoder",
  velocity: "velocity",
} as const;

/** One turn and back, with what was predicted on top of what was measured. */
export function MoveStep({ device, axis, onDone, disabled }: StepProps) {
  const at = { device: device.id, axis: axis.index };
  const scheme = useScheme();
  const action = useAction();
  const [there, setThere] = useState(false);
  const by = turnsBy(device);
  const [title, unit] = by === "position" ? (["Position", "microsteps"] as const) : (["Velocity", "pps"] as const);
  const shown = (by === "position" ? QUANTITIES : SPEEDS).filter((quantity) =>
    device.channels.some(({ name }) => name === `${quantity}.${axis.index}`),
  );
  const predicted = shown.some((quantity) => quantity === "predicted_position");
  const channels = shown.map((quantity) => `${quantity}.${axis.index}`);
  const { source, link } = useTelemetry(device.id, channels, Math.min(RATE_HZ, device.rate_max_hz));
  const rolling = useRolling(source, 5);
  return (
    <>
      <Text size="sm" mb="xs">
        {predicted &&
          "The predicted line is there before the motor goes: calculated as the chip itself does. Where they lie on each other, the axis does what it is told."}
        {by === "position" && !predicted && "The line should rise by a turn, and come to rest there."}
        {by === "velocity" &&
          "The velocity jumps to a turn a second, and back to 0: this driver has no ramp of its own."}
        {by === "steps from outside" &&
          "What steps it also makes its ramp: begin a move there, and see the velocity here."}
      </Text>
      <RollingSection title={title} rolling={rolling} link={link} name={device.name} spansS={[2, 5, 10, 20]}>
        <div className={classes.plot}>
          <Plot
            label={predicted ? "Position over time, predicted and measured" : `${title} over time`}
            series={shown.map((quantity) => ({
              label: NAMES[quantity],
              color: colorOf(quantity, scheme),
              unit,
              ...(quantity === "predicted_position" ? { dash: [6, 4] } : {}),
            }))}
            legend
            x={{ label: "time", unit: "s" }}
            scales={{ y: { unit } }}
            handle={rolling.plot(
              "position",
              channels.map((channel) => ({ channel, divisor: 1 })),
            )}
            onWindow={rolling.changeWindow}
            height="100%"
          />
        </div>
      </RollingSection>
      {action.failure && (
        <ProblemAlert error={action.failure.error} doing={action.failure.doing} onClose={action.dismiss} />
      )}
      <Group gap="xs" mt="sm">
        {by !== "steps from outside" && (
          <Button
            disabled={disabled || action.busy}
            onClick={() =>
              void action
                .run("Moving", () => turn(at, device, there ? -1 : 1))
                .then((moved) => moved && setThere(!there))
            }
          >
            {there ? "And back" : "Move one turn"}
          </Button>
        )}
        <Button variant="default" onClick={() => onDone()}>
          Go on
        </Button>
      </Group>
    </>
  );
}
