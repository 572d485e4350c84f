import { Button, Group, Text } from "@mantine/core";
import { IconArrowBackUp, IconRotateClockwise2 } from "@tabler/icons-react";
import { useState } from "react";
import { motion } from "../../api/motion";
import { ConditionCard } from "../../lib/condition/ConditionCard";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useAction } from "../bench/motion/useAction";
import { REVERSING } from "./flags";
import { NoTurn } from "./NoTurn";
import { SettingButton } from "./SettingButton";
import type { StepProps } from "./StepProps";
import { turnsBy } from "./steps";
import { turn } from "./turning";

/** Whether the motor turns, and the way that is called right. */
export function TurnStep({ device, axis, onDone, disabled }: StepProps) {
  const at = { device: device.id, axis: axis.index };
  const action = useAction();
  const [said, setSaid] = useState<"wrong" | "not" | null>(null);
  /** counts the looks at the coils */
  const [round, setRound] = useState(0);
  const by = turnsBy(device);
  const go = (turns: 1 | -1) => () => void action.run("Moving", () => turn(at, device, turns));
  return (
    <>
      <Text size="sm">
        Look at the shaft from its end. A turn forward should be the way that your machine calls forward.
      </Text>
      {by !== "position" && (
        <Text size="sm" mt="xs">
          {by === "velocity"
            ? "This driver counts no position: it turns for a second, at a turn a second, and its speed jumps."
            : "This driver turns only by the steps that it is given: let what steps it make a turn now, slowly."}
        </Text>
      )}
      <Group gap="xs" my="sm">
        {by !== "steps from outside" && (
          <>
            <Button
              leftSection={<IconRotateClockwise2 size={16} aria-hidden />}
              disabled={disabled || action.busy}
              onClick={go(1)}
            >
              One turn forward
            </Button>
            <Button
              variant="default"
              leftSection={<IconArrowBackUp size={16} aria-hidden />}
              disabled={disabled || action.busy}
              onClick={go(-1)}
            >
              One turn back
            </Button>
          </>
        )}
        <Button
          variant="light"
          color="red"
          disabled={device.state !== "connected"}
          onClick={() => void motion.stop(at, "ramp")}
        >
          Stop
        </Button>
      </Group>
      <ConditionCard device={device} axis={axis} nowS={undefined} />
      {action.failure && (
        <ProblemAlert error={action.failure.error} doing={action.failure.doing} onClose={action.dismiss} />
      )}
      <Group gap="xs" mt="sm">
        <Button onClick={() => onDone()}>It turned the right way</Button>
        <Button variant="default" onClick={() => setSaid("wrong")}>
          It turned the other way
        </Button>
        <Button
          variant="default"
          disabled={disabled}
          onClick={() => {
            setSaid("not");
            setRound((now) => now + 1);
          }}
        >
          It did not turn
        </Button>
      </Group>
      {said === "wrong" && (
        <SettingButton
          device={device.id}
          axis={axis.index}
          names={REVERSING}
          action={action}
          does="the other value turns the motor the other way."
          label="Reverse it"
          doing="Reversing the motor"
          otherwise="switch the power off, and swap the two wires of one coil."
        />
      )}
      {said === "not" && <NoTurn key={round} device={device} axis={axis.index} />}
      <Text size="sm" className="dim" mt="xs">
        It hums and does not turn: one coil has no contact, or its wires are crossed with the other one's.{" "}
        <b>It did not turn</b> asks the driver what it sees.
      </Text>
    </>
  );
}
