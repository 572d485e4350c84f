import { Button, Group, Text } from "@mantine/core";
import { useState } from "react";
import { ConditionCard } from "../../lib/condition/ConditionCard";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { StartUpPlan } from "../../lib/startup/StartUpPlan";
import { useAction } from "../bench/motion/useAction";
import { StudyView } from "../tune/StudyView";
import { useChanges, useStudies } from "../tune/useStudies";
import classes from "./firstRun.module.css";
import { figuresOf } from "./motorFigures";
import type { StepProps } from "./StepProps";
import { encoderLook } from "./steps";
import { Term } from "./Term";
import { turn } from "./turning";

/** Whether there is an encoder, which way it counts, and how many lines it has, by who can look at it. */
export function EncoderStep(props: StepProps) {
  switch (encoderLook(props.device)) {
    case "study":
      return <ByStudy {...props} />;
    case "condition":
      return <ByCondition {...props} />;
    case "none":
      return <None {...props} />;
  }
}

const COUNTS_A_LINE = 4;
const LINES_MAX = 1 << 20;

function ByStudy({ device, axis, progress, onDone, disabled }: StepProps) {
  const studies = useStudies();
  const [begun, setBegun] = useState<string | null>(null);
  const [lines, setLines] = useState<number | null>(null);
  const changes = useChanges(setBegun);
  const own = studies.data?.studies.find(
    (study) => study.device === device.id && study.axis === axis.index && study.kind === "first_look",
  );
  const shown = begun ?? own?.id ?? null;
  const wish = { device: device.id, axis: axis.index, study: { kind: "first_look" as const } };
  return (
    <>
      <Text size="sm">
        An <Term name="encoder">encoder</Term> at the shaft tells how far it really went. Say how many lines a turn it
        has, as its plate says; 1,000 where nobody knows. The study then turns the motor one turn to either side, and
        finds whether that is right, and which way it counts; what it would set right is a button.
      </Text>
      <div className={classes.fields}>
        <NumberField
          label="Lines a turn"
          integer
          min={1}
          max={LINES_MAX}
          value={lines}
          onChange={setLines}
          onClear={() => setLines(null)}
        />
      </div>
      {lines !== null && (
        <StartUpPlan
          device={device.id}
          body={{ axes: [axis.index], motor: figuresOf(progress), counts_per_rev: COUNTS_A_LINE * lines }}
          axisNames={device.axes.map(({ name }) => name)}
          disabled={disabled}
        />
      )}
      {changes.start.error && (
        <ProblemAlert error={changes.start.error} doing="Beginning the study" onClose={() => changes.start.reset()} />
      )}
      <Group gap="xs" my="sm">
        <Button disabled={disabled} loading={changes.start.isPending} onClick={() => changes.start.mutate(wish)}>
          Look (moves)
        </Button>
        <Button variant="default" onClick={() => onDone()}>
          {shown === null ? "There is none" : "Go on"}
        </Button>
      </Group>
      {shown !== null && <StudyView id={shown} changes={changes} />}
    </>
  );
}

/** A module's own encoder: after a turn its condition tells what is wrong with it, with the button that helps. */
function ByCondition({ device, axis, onDone, disabled }: StepProps) {
  const at = { device: device.id, axis: axis.index };
  const action = useAction();
  return (
    <>
      <Text size="sm" mb="xs">
        The <Term name="encoder">encoder</Term> of a module is built in, or set by its parameters. Turn the motor once,
        and back: where both do not agree, the condition says so, and by how much.
      </Text>
      <ConditionCard device={device} axis={axis} nowS={undefined} />
      {action.failure && (
        <ProblemAlert error={action.failure.error} doing={action.failure.doing} onClose={action.dismiss} />
      )}
      <Group gap="xs" my="sm">
        <Button disabled={disabled || action.busy} onClick={() => void action.run("Moving", () => turn(at, device, 1))}>
          One turn forward
        </Button>
        <Button
          variant="default"
          disabled={disabled || action.busy}
          onClick={() => void action.run("Moving", () => turn(at, device, -1))}
        >
          One turn back
        </Button>
        <Button variant="default" onClick={() => onDone()}>
          Go on
        </Button>
      </Group>
    </>
  );
}

function None({ device, onDone }: StepProps) {
  return (
    <>
      <Text size="sm">
        A {device.about.title} reads no <Term name="encoder">encoder</Term>: where the shaft really is, nobody sees, and
        lost steps show only at the next search for a switch. So keep well below the speed at which the motor slips, and
        go on.
      </Text>
      <Button mt="sm" onClick={() => onDone()}>
        Go on
      </Button>
    </>
  );
}
