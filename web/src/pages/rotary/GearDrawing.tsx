import { useRef } from "react";
import { coordinate } from "../../lib/format";
import { useFrame } from "../../live/useFrame";
import { pair } from "./gears";
import classes from "./rotary.module.css";

interface Props {
  motorTeeth: number;
  drivenTeeth: number;
  /** of the driven shaft [deg]; NaN while unknown */
  angle: () => number;
}

/** Motor and shaft as gears that turn as the axis does. */
export function GearDrawing({ motorTeeth, drivenTeeth, angle }: Props) {
  const motor = useRef<SVGGElement>(null);
  const driven = useRef<SVGGElement>(null);
  const drawn = pair(motorTeeth, drivenTeeth, 150);
  const height = 2 * Math.max(drawn.motor.radius, drawn.driven.radius) + 12;
  useFrame(() => {
    const shaft = angle();
    if (Number.isNaN(shaft)) return;
    driven.current?.setAttribute("transform", `translate(${drawn.driven.x}) rotate(${coordinate(shaft)})`);
    // meshed: it turns the other way, and a gap of one faces a tooth of the other
    const mesh = 90 + (drivenTeeth / motorTeeth) * (90 - shaft) + 180 - 180 / drawn.motor.teeth;
    motor.current?.setAttribute("transform", `translate(${drawn.motor.x}) rotate(${coordinate(mesh % 360)})`);
  });
  return (
    <svg
      viewBox={`-75 ${-height / 2} 150 ${height}`}
      className={classes.gears}
      role="img"
      aria-label={`${motorTeeth} teeth on the motor turn ${drivenTeeth} teeth on the shaft`}
    >
      <g ref={motor} transform={`translate(${drawn.motor.x})`}>
        <path d={drawn.motor.path} className={classes.gearMotor} />
        <circle
          r={Math.max(2, drawn.motor.radius * 0.18)}
          fill="var(--ground)"
          stroke="var(--slate)"
          strokeWidth={0.8}
        />
        <path
          d={`M0 ${-drawn.motor.radius * 0.35}V${-drawn.motor.radius * 0.72}`}
          stroke="var(--mantine-color-text)"
          strokeWidth={1.6}
          strokeLinecap="round"
        />
      </g>
      <g ref={driven} transform={`translate(${drawn.driven.x})`}>
        <path d={drawn.driven.path} className={classes.gearDriven} />
        <circle
          r={Math.max(2, drawn.driven.radius * 0.18)}
          fill="var(--ground)"
          stroke="var(--slate)"
          strokeWidth={0.8}
        />
        <path
          d={`M0 ${-drawn.driven.radius * 0.35}V${-drawn.driven.radius * 0.72}`}
          stroke="var(--mantine-color-text)"
          strokeWidth={1.6}
          strokeLinecap="round"
        />
      </g>
    </svg>
  );
}
