import { Button } from "@mantine/core";
import type { Device } from "../../api/queries";
import { useStanding } from "../../live/useStanding";
import { ProblemAlert } from "../ProblemAlert";
import { ConditionMark } from "./ConditionMark";
import { ConditionPopover } from "./ConditionPopover";
import classes from "./condition.module.css";
import { KINDS, referencedWords, sentence, sinceWords } from "./kinds";
import { RemedyButton } from "./RemedyButton";
import { useRemedies } from "./remedy";

interface Props {
  device: Device;
  axis: Device["axes"][number];
  /** device time of the newest reading [s] */
  nowS: number | undefined;
}

/** The condition of the selected axis, big: what is so, why, and the button that helps. */
export function ConditionCard({ device, axis, nowS }: Props) {
  const { condition, referenced, ground_truth: truth } = useStanding(device.id, axis.index);
  const remedies = useRemedies();
  return (
    <>
      <section
        className={`${classes.card} stack rigid gap-2`}
        data-tone={KINDS[condition.kind].tone}
        aria-label={`Condition of ${axis.name}`}
        data-testid="condition-card"
      >
        <div className={`${classes.head} row between gap-6`}>
          <ConditionMark kind={condition.kind} size={20} />
          <span className="ink text-12 nowrap">{sinceWords(condition, nowS)}</span>
        </div>
        <p className={`${classes.cause} m-0 text-12 tight`} title={condition.cause}>
          {sentence(condition.cause)}
        </p>
        {truth && (
          <p className="clip m-0 text-12 tight" title={truth.summary}>
            <b>Really:</b> {truth.summary}
          </p>
        )}
        <div className={`push-down row between gap-6`}>
          {condition.remedy ? (
            <RemedyButton remedy={condition.remedy} remedies={remedies} main />
          ) : (
            <span className="ink text-12 nowrap">{referencedWords(referenced)}</span>
          )}
          <ConditionPopover
            device={device}
            axis={axis}
            target={(toggle, opened) => (
              <Button
                size="compact-xs"
                variant="subtle"
                color="gray"
                flex="none"
                onClick={toggle}
                aria-expanded={opened}
              >
                Why
              </Button>
            )}
          />
        </div>
      </section>
      {remedies.isError && (
        <ProblemAlert error={remedies.error} doing={sentence(remedies.variables.label)} onClose={remedies.reset} />
      )}
    </>
  );
}
