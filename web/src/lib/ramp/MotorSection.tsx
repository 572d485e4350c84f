import { Switch } from "@mantine/core";
import { memo, useMemo } from "react";
import { Plot } from "../../plots/Plot";
import type { Overlay } from "../../plots/types";
import { Card } from "../Card";
import { NumberField } from "../NumberField";
import { useScheme } from "../useScheme";
import type { Answer } from "./answer";
import { FIELDS, type Motor, type MotorKey, marginText } from "./motor";
import classes from "./ramp.module.css";
import { engineering } from "./scales";
import { torqueColor } from "./torque";

interface Props {
  motor: Motor;
  onMotor: (change: Partial<Motor>) => void;
  answer: Answer | undefined;
  /** what one of the shown velocity unit is [pps] */
  perVelocity: number;
  velocityUnit: string;
}

/** The motor behind the ramp: what it can give at each speed, and the way that the ramp takes below that. */
export const MotorSection = memo(function MotorSection(props: Props) {
  const { motor, onMotor, answer, perVelocity, velocityUnit } = props;
  const torque = motor.shown ? answer?.torque : null;
  return (
    <Card
      title="Motor"
      note={
        torque ? (
          <span className={torque.margin < 0 ? "m-0 caution text-12" : undefined}>
            at worst {marginText(torque.margin)}
          </span>
        ) : (
          ""
        )
      }
      actions={
        <Switch
          label="compare with a motor"
          checked={motor.shown}
          onChange={(event) => onMotor({ shown: event.currentTarget.checked })}
        />
      }
    >
      {motor.shown ? (
        <div className={`${classes.motor} columns gap-12`}>
          <div className="halves gap-8">
            {FIELDS.map(({ key, label, unit, title, zero }) => (
              <NumberField
                key={key}
                label={label}
                title={title}
                unit={unit}
                value={motor[key]}
                min={zero ? 0 : 1e-6}
                max={1e6}
                step={motor[key] / 20 || 0.01}
                onChange={(value) => onMotor({ [key]: value } as Pick<Motor, MotorKey>)}
              />
            ))}
          </div>
          {answer && torque && (
            <SpeedTorque answer={answer} torque={torque} perVelocity={perVelocity} velocityUnit={velocityUnit} />
          )}
        </div>
      ) : (
        <p className="hint m-0">With the motor's data the ramp is compared with the torque there is at each speed.</p>
      )}
    </Card>
  );
});

function SpeedTorque(props: {
  answer: Answer;
  torque: NonNullable<Answer["torque"]>;
  perVelocity: number;
  velocityUnit: string;
}) {
  const { answer, torque, perVelocity, velocityUnit } = props;
  const scheme = useScheme();
  const color = torqueColor(scheme);
  const data = useMemo(
    () => [torque.speed_pps.map((speed) => speed / perVelocity), torque.curve_nm] as const,
    [torque, perVelocity],
  );
  const path = useMemo<Overlay[]>(() => {
    // without the last sample, which stands: there is no motion left to ask anything
    const rows = answer.velocity_pps.slice(0, -1);
    const at = (rising: boolean): Overlay => {
      const kept = rows
        .map((velocity, row) => [Math.abs(velocity), velocity * (answer.acceleration_pps2[row] ?? 0), row] as const)
        .filter(([, power]) => (rising ? power >= 0 : power < 0));
      return {
        x: kept.map(([speed]) => speed / perVelocity),
        y: kept.map(([, , row]) => Math.abs(torque.required_nm[row] ?? 0)),
        color: rising ? (scheme === "light" ? "#a86400" : "#ffc14d") : scheme === "light" ? "#0068a8" : "#56b4e9",
        dots: 2,
      };
    };
    return [at(true), at(false)];
  }, [answer, torque, perVelocity, scheme]);
  return (
    <div className="shrink">
      <Plot
        label="Torque over speed"
        summary={`At worst ${marginText(torque.margin)}`}
        series={[{ label: "the motor can", color, unit: "Nm", width: 2, fill: `${color}22` }]}
        data={data}
        overlays={path}
        height={196}
        limit={[0, (torque.speed_pps.at(-1) ?? 1) / perVelocity]}
        x={{ label: "speed", unit: velocityUnit, ticks: engineering }}
        scales={{ y: { include: [0], unit: "Nm" } }}
        legend
      />
      <p className="under-plot lines-12 hint m-0 mt-4">
        <span>
          <i className="key-line key-dotted hue-orange" aria-hidden /> speeding up
        </span>
        <span>
          <i className="key-line key-dotted hue-blue" aria-hidden /> braking
        </span>
      </p>
    </div>
  );
}
