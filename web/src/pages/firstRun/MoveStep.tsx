import { Button, Group, Text } from "@mantine/core";
import { useState } from "react";
import { motion } from "../../api/motion";
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

const RATE_HZ = 100;
const QUANTITIES = ["position", "predicted_position", "encoder_position"] as const;
const NAMES = { position: "position", predicted_position: "predicted", encoder_position: "encoder" } as const;

/** One turn and back, with what was predicted on top of what was measured. */
export function MoveStep({ device, axis, onDone, disabled }: StepProps) {
  const at = { device: device.id, axis: axis.index };
  const scheme = useScheme();
  const action = useAction();
  const [there, setThere] = useState(false);
  const shown = QUANTITIES.filter((quantity) =>
    device.channels.some(({ name }) => name === `${quantity}.${axis.index}`),
  );
  const channels = shown.map((quantity) => `${quantity}.${axis.index}`);
  const { source, link } = useTelemetry(device.id, channels, Math.min(RATE_HZ, device.rate_max_hz));
  const rolling = useRolling(source, 5);
  return (
    <>
      <Text size="sm" mb="xs">
        The predicted line is there before the motor goes: calculated as the chip itself does. Where they lie on each
        other, the axis does what it is told.
      </Text>
      <RollingSection title="Position" rolling={rolling} link={link} name={device.name} spansS={[2, 5, 10, 20]}>
        <div className={classes.plot}>
          <Plot
            label="Position over time, predicted and measured"
            series={shown.map((quantity) => ({
              label: NAMES[quantity],
              color: colorOf(quantity, scheme),
              unit: "microsteps",
              ...(quantity === "predicted_position" ? { dash: [6, 4] } : {}),
            }))}
            legend
            x={{ label: "time", unit: "s" }}
            scales={{ y: { unit: "microsteps" } }}
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
        <Button
          disabled={disabled || action.busy}
          onClick={() =>
            void action
              .run("Moving", () => motion.move(at, { target: there ? -1 : 1, relative: true, unit: "rev" }))
              .then((moved) => moved && setThere(!there))
          }
        >
          {there ? "And back" : "Move one turn"}
        </Button>
        <Button variant="default" onClick={() => onDone()}>
          Go on
        </Button>
      </Group>
    </>
  );
}
