import { type ReactNode, useMemo } from "react";
import { Page } from "../Page";
import { ProblemAlert } from "../ProblemAlert";
import type { Answer } from "./answer";
import { LiveMotion } from "./LiveMotion";
import { MotorSection } from "./MotorSection";
import { channelsOf } from "./overlay";
import { factor } from "./scales";
import { TimeBars, type TimedRival } from "./TimeBars";
import type { AnyDesigner } from "./useDesigner";

interface Props {
  title: string;
  designer: AnyDesigner;
  /** the latest, for the motion that is laid over it */
  answer: Answer | undefined;
  /** the one that is shown beside the plots */
  good: Answer | undefined;
  registers: ReactNode;
  send: ReactNode;
  plots: ReactNode;
  rivals: readonly TimedRival[];
  /** why there is nothing to compare; null where there is */
  incomparable: string | null;
  comparing?: ReactNode;
}

/** The page of a ramp's designer: registers and what is sent on the left, plots, times and motor on the right. */
export function DesignerPage(props: Props) {
  const { title, designer, answer, good } = props;
  const { device, axis, connected, readings, units, scale, live } = designer;
  const laid = useMemo(() => designer.kinds.filter((kind) => kind !== "jerk"), [designer.kinds]);
  const factors = useMemo(
    () => Object.fromEntries(laid.map((kind) => [kind, factor(kind, units, scale)])),
    [laid, units, scale],
  );
  return (
    <Page name={title}>
      {readings.isError && connected && (
        <ProblemAlert error={readings.error} doing={`Reading ${device?.name}`} retry={() => void readings.refetch()} />
      )}
      {device && connected && channelsOf(device, axis, laid).length > 0 && (
        <LiveMotion
          device={device}
          axis={axis}
          way={designer.way}
          endS={answer?.time_s.at(-1) ?? 1}
          factors={factors}
          plots={live.plots}
          drawing={live.drawing}
          onSeen={live.setSeen}
        />
      )}
      <div className="columns design until-75">
        <div className="column">
          {props.registers}
          {props.send}
        </div>
        <div className="column ahead">
          {props.plots}
          <TimeBars
            seconds={good?.duration_s ?? null}
            rivals={props.rivals}
            why={props.incomparable}
            {...(props.comparing === undefined ? {} : { actions: props.comparing })}
          />
          <MotorSection
            motor={designer.motor}
            onMotor={designer.onMotor}
            answer={good}
            perVelocity={factor("velocity", units, scale)}
            velocityUnit={units.velocity}
          />
        </div>
      </div>
    </Page>
  );
}
