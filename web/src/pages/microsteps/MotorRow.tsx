import { Button } from "@mantine/core";
import { IconArrowsLeftRight, IconPlayerStop } from "@tabler/icons-react";
import { ConditionMark } from "../../lib/condition/ConditionMark";
import { fixed } from "../../lib/format";
import { useStanding } from "../../live/useStanding";
import classes from "./Microsteps.module.css";
import type { Motor } from "./useMotor";

/** Position and velocity beside the buttons that run and stop the motor. */
export function MotorRow({ motor }: { motor: Motor }) {
  const { at, live, run, stop, connected, turns } = motor;
  const state = live.data;
  const { condition } = useStanding(at.device, at.axis);
  return (
    <div className={`${classes.live} row wrap gap-8`}>
      <dl className={`stacked flex gap-12 m-0 text-13 grow ${live.isError || !connected ? "dim" : ""}`}>
        <div>
          <dt>position</dt>
          <dd className="num">{state ? `${fixed(state.position)} µsteps` : "–"}</dd>
        </div>
        <div>
          <dt>velocity</dt>
          <dd className="num">{state ? fixed(state.velocity_pps, 0, "pps") : "–"}</dd>
        </div>
        <div>
          <dt>motor</dt>
          <dd>
            <ConditionMark kind={condition.kind} />
          </dd>
        </div>
      </dl>
      <Button
        variant="light"
        leftSection={<IconArrowsLeftRight size={14} aria-hidden />}
        disabled={!connected}
        loading={run.isPending}
        title={`${turns} turns there and back, until stopped`}
        onClick={() => run.mutate()}
      >
        Shuttle
      </Button>
      <Button
        variant="default"
        leftSection={<IconPlayerStop size={14} aria-hidden />}
        disabled={!connected}
        onClick={() => stop.mutate()}
      >
        Stop
      </Button>
    </div>
  );
}
