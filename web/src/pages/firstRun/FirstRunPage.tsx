import { Button, Group, Text } from "@mantine/core";
import { IconCircle, IconCircleCheck, IconRoute } from "@tabler/icons-react";
import { useIsMutating } from "@tanstack/react-query";
import { lazy, Suspense } from "react";
import { can, type Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { ConditionMark } from "../../lib/condition/ConditionMark";
import { NoDevice, Waiting } from "../../lib/NoDevice";
import { Page } from "../../lib/Page";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { useSessionKept } from "../../lib/useKept";
import { useSelectedAxis } from "../../live/selection";
import { useStanding } from "../../live/useStanding";
import classes from "./firstRun.module.css";
import { KeepStep } from "./KeepStep";
import { LimitsStep } from "./LimitsStep";
import { LinkStep } from "./LinkStep";
import { MotorStep } from "./MotorStep";
import { SetUpStep } from "./SetUpStep";
import type { StepProps } from "./StepProps";
import { SwitchesStep } from "./SwitchesStep";
import { BEGIN, before, done, type Progress, progressKey, STEPS, type StepId } from "./steps";
import { TurnStep } from "./TurnStep";

const MoveStep = lazy(() => import("./MoveStep").then((part) => ({ default: part.MoveStep })));
const EncoderStep = lazy(() => import("./EncoderStep").then((part) => ({ default: part.EncoderStep })));

const CONTENTS: Record<StepId, React.ComponentType<StepProps>> = {
  link: LinkStep,
  motor: MotorStep,
  limits: LimitsStep,
  setUp: SetUpStep,
  turn: TurnStep,
  encoder: EncoderStep,
  switches: SwitchesStep,
  move: MoveStep,
  keep: KeepStep,
};

/** From an axis that nobody has set up to one that moves, safely, step by step. */
export default function FirstRunPage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  if (waiting) return <Waiting page="First run" />;
  if (!device || !entry || !can(device, "motion")) return <NoDevice page="First run" icon={<IconRoute size={22} />} />;
  return <FirstRun key={key} device={device} axis={entry} />;
}

function FirstRun({ device, axis }: { device: Device; axis: Device["axes"][number] }) {
  const [progress, setProgress] = useSessionKept<Progress>(progressKey(device.id, axis.index), BEGIN);
  const { condition } = useStanding(device.id, axis.index);
  const settingUp = useIsMutating({ mutationKey: ["start-up", device.id] }) > 0;
  const step = STEPS.find(({ id }) => id === progress.at) ?? STEPS[0];
  if (step === undefined) return null;
  const Step = CONTENTS[step.id];
  const number = STEPS.indexOf(step) + 1;
  // a step that is gone on from while it is still written would be answered by the next one
  const disabled = device.state !== "connected" || settingUp;
  return (
    <Page name="First run">
      <DeviceNotice device={device} />
      <div className={classes.wizard}>
        <Card title={`${device.name} · ${axis.name}`} note={`${progress.done.length} of ${STEPS.length} done`}>
          <ol className={classes.steps} aria-label="Steps">
            {STEPS.map(({ id, title }) => (
              <li key={id}>
                <button
                  type="button"
                  className={classes.step}
                  aria-current={id === step.id ? "step" : undefined}
                  onClick={() => setProgress({ ...progress, at: id })}
                >
                  {progress.done.includes(id) ? (
                    <IconCircleCheck size={18} className={classes.done} aria-label="done" />
                  ) : (
                    <IconCircle size={18} className="dim" aria-hidden />
                  )}
                  {title}
                </button>
              </li>
            ))}
          </ol>
          <Group gap={6} mt="sm">
            <ConditionMark kind={condition.kind} size={18} />
          </Group>
        </Card>
        <Card title={`${number}. ${step.title}`} note={step.does} data-testid="first-run-step">
          <Suspense>
            <Step
              key={step.id}
              device={device}
              axis={axis}
              disabled={disabled}
              progress={progress}
              onDone={(motor) => setProgress({ ...done(progress, step.id), motor: motor ?? progress.motor })}
            />
          </Suspense>
          {number > 1 && (
            <Button
              size="compact-sm"
              variant="subtle"
              mt="md"
              onClick={() => setProgress({ ...progress, at: before(step.id) })}
            >
              Back
            </Button>
          )}
        </Card>
      </div>
      <Text size="sm" className="dim">
        Each step can be left out and repeated alone. STOP ALL and Escape stop every motor at any time.
      </Text>
    </Page>
  );
}
