import { coordinate, fixed } from "../../lib/format";
import classes from "./bench.module.css";

/** How an emulated motor really is: what no command of its device tells. */
export interface Truth {
  load_angle_deg: number;
  lost_fullsteps: number;
  current_a_a: number;
  current_b_a: number;
  torque_nm: number;
  speed_rad_s: number;
  bridges: string;
}

const SLIP_DEG = 90;

function point(degrees: number, radius: number): string {
  const angle = (degrees * Math.PI) / 180;
  return `${coordinate(64 + radius * Math.sin(angle), 1)} ${coordinate(64 - radius * Math.cos(angle), 1)}`;
}

/** One electrical turn, four full steps: the field points up, and the rotor is as far off as the load pulls it. */
export function RotorDial({ truth }: { truth: Truth }) {
  const behind = truth.load_angle_deg;
  const slips = Math.abs(behind) > SLIP_DEG;
  return (
    <div className={`${classes.dial} grid gap-8 mid`} data-testid="rotor-dial" data-slip={slips}>
      <svg
        width={128}
        height={128}
        viewBox="-4 -4 136 136"
        role="img"
        aria-label={`The rotor is ${fixed(behind, 1)} electrical degrees behind its field`}
      >
        <circle cx={64} cy={64} r={50} fill="var(--well)" stroke="var(--line)" />
        <path
          d={`M64 64L${point(SLIP_DEG, 50)}A50 50 0 0 1 ${point(360 - SLIP_DEG, 50)}Z`}
          fill="color-mix(in srgb, var(--mantine-color-red-filled) 20%, transparent)"
        />
        {[0, 90, 180, 270].map((angle) => (
          <text
            key={angle}
            x={64 + 57 * Math.sin((angle * Math.PI) / 180)}
            y={67 - 57 * Math.cos((angle * Math.PI) / 180)}
            textAnchor="middle"
            className="text-12 fill-dim"
          >
            {angle > 180 ? angle - 360 : angle}°
          </text>
        ))}
        <path d="M64 64V18" stroke="var(--lamp)" strokeWidth={3} />
        <g transform={`rotate(${coordinate(-behind)} 64 64)`}>
          <path d="M60 64L64 24L68 64L64 88Z" className={`${classes.dialRotor} fill-accent`} data-slip={slips} />
        </g>
        <circle cx={64} cy={64} r={4} fill="var(--well)" stroke="var(--line)" />
      </svg>
      <dl className="facts pairs m-0 text-12 tight">
        <dt>load angle</dt>
        <dd className="num">{fixed(behind, 1)}°</dd>
        <dt>lost</dt>
        <dd className="num" data-testid="lost-steps">
          {fixed(truth.lost_fullsteps)} steps
        </dd>
        <dt>coil A</dt>
        <dd className="num">{fixed(truth.current_a_a, 2, "A")}</dd>
        <dt>coil B</dt>
        <dd className="num">{fixed(truth.current_b_a, 2, "A")}</dd>
        <dt>torque</dt>
        <dd className="num">{fixed(truth.torque_nm * 1000, 0, "mN·m")}</dd>
        <dt>speed</dt>
        <dd className="num">{fixed((truth.speed_rad_s * 60) / (2 * Math.PI), 0, "rpm")}</dd>
        <dt>bridges</dt>
        <dd>{truth.bridges}</dd>
      </dl>
    </div>
  );
}
