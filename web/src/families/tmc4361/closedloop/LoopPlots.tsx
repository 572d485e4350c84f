import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import type { LinkState, TelemetrySource } from "../../../live/TelemetrySource";
import { RollingSection } from "../../../pages/module/RollingSection";
import { useRolling } from "../../../pages/module/useRolling";
import { Plot } from "../../../plots/Plot";
import type { Level } from "../../../plots/types";

const SPANS_S = [0.5, 1, 2, 5, 10, 20, 60] as const;
const PLAIN = { light: "#6b7480", dark: "#7a828c" };

interface Props {
  source: TelemetrySource;
  link: LinkState;
  name: string;
  axis: number;
  /** deviations at which something changes [microsteps]; null while unknown */
  tolerance: number | null;
  failAt: number | null;
  betaDeg: number | null;
}

/** Commanded, actual and encoder over time, how far they are apart, the load angle, and both speeds. */
export function LoopPlots({ source, link, name, axis, tolerance, failAt, betaDeg }: Props) {
  const scheme = useScheme();
  const rolling = useRolling(source, 5);
  const both = (id: string, y: number | null, label: string): Level[] =>
    y === null || y === 0
      ? []
      : [y, -y].map((at) => ({ id: `${id}${at}`, y: at, color: PLAIN[scheme], label, fixed: true }));
  const common = { group: "closed-loop", onWindow: rolling.changeWindow, height: "100%", legend: true } as const;
  const trace = (quantity: string) => ({ channel: `${quantity}.${axis}`, divisor: 1 });
  return (
    <RollingSection title="Live" rolling={rolling} link={link} name={name} spansS={SPANS_S}>
      <div className="strip strip-tall">
        <Plot
          {...common}
          label={`Target, commanded position and encoder of ${name} over time`}
          series={[
            {
              label: "target",
              color: colorOf("target_position", scheme),
              unit: "microsteps",
              dash: [4, 3],
              stepped: true,
            },
            { label: "encoder", color: colorOf("encoder_position", scheme), unit: "microsteps" },
            { label: "commanded", color: colorOf("position", scheme), unit: "microsteps" },
          ]}
          x={{ axis: false }}
          scales={{ y: { unit: "microsteps" } }}
          handle={rolling.plot("position", [trace("target_position"), trace("encoder_position"), trace("position")])}
        />
      </div>
      <div className="strip">
        <Plot
          {...common}
          label={`Deviation of ${name} over time`}
          series={[{ label: "deviation", color: colorOf("deviation", scheme), unit: "microsteps" }]}
          x={{ axis: false }}
          scales={{ y: { unit: "microsteps", include: [0] } }}
          levels={[...both("tolerance", tolerance, "CL_TOLERANCE"), ...both("fail", failAt, "ENC_POS_DEV_TOL")]}
          handle={rolling.plot("deviation", [trace("deviation")])}
        />
      </div>
      <div className="strip">
        <Plot
          {...common}
          label={`Load angle of ${name} over time, electrical degrees`}
          series={[{ label: "load angle", color: colorOf("load_angle", scheme), unit: "deg" }]}
          x={{ axis: false }}
          scales={{ y: { unit: "deg", include: [-30, 30] } }}
          levels={both("beta", betaDeg, "CL_BETA")}
          handle={rolling.plot("angle", [trace("load_angle")])}
        />
      </div>
      <div className="strip strip-tall">
        <Plot
          {...common}
          label={`Speed of command and encoder of ${name} over time`}
          series={[
            { label: "encoder", color: colorOf("encoder_velocity", scheme), unit: "pps" },
            { label: "commanded", color: colorOf("velocity", scheme), unit: "pps" },
          ]}
          x={{ label: "time", unit: "s" }}
          scales={{ y: { unit: "pps", include: [0] } }}
          handle={rolling.plot("speed", [trace("encoder_velocity"), trace("velocity")])}
        />
      </div>
    </RollingSection>
  );
}
