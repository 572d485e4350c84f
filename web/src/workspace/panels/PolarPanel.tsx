import { useState } from "react";
import { colorOf } from "../../lib/palette";
import { useScheme } from "../../lib/useScheme";
import { useTelemetry } from "../../live/useTelemetry";
import { AngleView } from "../../pages/encoder/AngleView";
import type { Direction } from "../../pages/encoder/angleMap";
import { KEEP_S, RATE_HZ, turnShare } from "../../pages/encoder/EncoderView";
import { channelsFor, ENCODERS, encodersOf, useAngleMaps } from "../../pages/encoder/useEncoder";
import { Misfit } from "../Misfit";
import type { PanelProps } from "../panel";

/** How far the encoder is from the motor, around the turn. */
export function PolarPanel(props: PanelProps) {
  const { device, axis } = props;
  if (encodersOf(device, axis.index).length === 0)
    return <Misfit title="Encoder" why={`${device.name} tells no encoder of ${axis.name}.`} />;
  return <Polar key={`${device.id}/${axis.index}`} {...props} />;
}

function Polar({ device, axis }: PanelProps) {
  const scheme = useScheme();
  const [direction, setDirection] = useState<Direction>("both");
  const shown = encodersOf(device, axis.index).slice(0, 1);
  const rateHz = Math.min(RATE_HZ, device.rate_max_hz);
  const { source, buffer } = useTelemetry(device.id, channelsFor(device, axis.index, shown), rateHz, KEEP_S);
  const microsteps = axis.microsteps_per_full_step ?? 256;
  const maps = useAngleMaps(source, axis.index, axis.full_steps_per_rev, microsteps);
  const perTurn = axis.full_steps_per_rev * microsteps;
  const curves = shown.map((which) => ({
    map: maps[which],
    color: colorOf(ENCODERS[which].deviation, scheme),
    label: ENCODERS[which].label,
  }));
  return (
    <AngleView
      curves={curves}
      direction={direction}
      onDirection={setDirection}
      shaft={() => turnShare(buffer.last(`position.${axis.index}`), perTurn)}
      moving={false}
      onClear={() => {
        for (const { map } of curves) map.clear();
      }}
    />
  );
}
