import { Button, Stack, Text } from "@mantine/core";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { ReferenceSection } from "../bench/motion/ReferenceSection";
import { useAction } from "../bench/motion/useAction";
import type { StepProps } from "./StepProps";
import { Term } from "./Term";

/** Where zero is: at a switch, or here. */
export function SwitchesStep({ device, axis, onDone, disabled }: StepProps) {
  const action = useAction();
  return (
    <Stack gap="sm">
      <Text size="sm">
        Press each <Term name="reference-switch">switch</Term> by hand first, and see on the page Bench that its lamp
        goes on: a search for a switch that is not there ends at the end of the travel. Without switches, call this
        place zero.
      </Text>
      <ReferenceSection
        at={{ device: device.id, axis: axis.index }}
        device={device}
        action={action}
        disabled={disabled || action.busy}
      />
      {action.failure && (
        <ProblemAlert error={action.failure.error} doing={action.failure.doing} onClose={action.dismiss} />
      )}
      <div>
        <Button onClick={() => onDone()}>Go on</Button>
      </div>
    </Stack>
  );
}
