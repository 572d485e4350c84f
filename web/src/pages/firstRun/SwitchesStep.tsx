import { Button, Stack, Text } from "@mantine/core";
import { can } from "../../api/queries";
import { later } from "../../lib/later";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { ReferenceSection } from "../bench/motion/ReferenceSection";
import { useAction } from "../bench/motion/useAction";
import { PressSwitches } from "./PressSwitches";
import type { StepProps } from "./StepProps";
import { turnsBy } from "./steps";
import { Term } from "./Term";

const ModuleSearch = later(() => import("../../families/tmcl/search/ModuleSearch").then((part) => part.ModuleSearch));

/** Where zero is: at a switch, or here. */
export function SwitchesStep({ device, axis, onDone, disabled }: StepProps) {
  const at = { device: device.id, axis: axis.index };
  const action = useAction();
  const Search = can(device, "parameters") && can(device, "home_switch") ? ModuleSearch : ReferenceSection;
  return (
    <Stack gap="sm">
      {turnsBy(device) === "position" ? (
        <>
          <Text size="sm">
            First press each <Term name="reference-switch">switch</Term> by hand, that at the end that forward goes to
            as the right one: a search for one that is not there ends at the end of the travel, and one that is swapped
            stops nothing. Without switches, call this place zero.
          </Text>
          <PressSwitches device={device} axis={axis.index} action={action} disabled={disabled || action.busy} />
          <Search at={at} device={device} action={action} disabled={disabled || action.busy} />
        </>
      ) : (
        <Text size="sm">
          A {device.about.title} has no inputs for <Term name="reference-switch">switches</Term>, and no position that
          could be zero: both are with what steps it. Go on.
        </Text>
      )}
      {action.failure && (
        <ProblemAlert error={action.failure.error} doing={action.failure.doing} onClose={action.dismiss} />
      )}
      <div>
        <Button onClick={() => onDone()}>Go on</Button>
      </div>
    </Stack>
  );
}
