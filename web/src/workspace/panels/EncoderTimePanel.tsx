import { useState } from "react";
import { useTelemetry } from "../../live/useTelemetry";
import { KEEP_S, RATE_HZ } from "../../pages/encoder/EncoderView";
import { LivePlots } from "../../pages/encoder/LivePlots";
import { channelsFor, encodersOf } from "../../pages/encoder/useEncoder";
import { useStops } from "../../pages/module/useStops";
import { Misfit } from "../Misfit";
import type { PanelProps } from "../panel";

/** Motor and encoder over time, and how far they are apart; the limits of that are on the page Encoder. */
export function EncoderTimePanel(props: PanelProps) {
  const { device, axis } = props;
  if (encodersOf(device, axis.index).length === 0)
    return <Misfit title="Encoder" why={`${device.name} tells no encoder of ${axis.name}.`} />;
  return <Over key={`${device.id}/${axis.index}`} {...props} />;
}

function Over({ device, axis }: PanelProps) {
  const choices = encodersOf(device, axis.index);
  const [shown, setShown] = useState(choices.slice(0, 1));
  const rateHz = Math.min(RATE_HZ, device.rate_max_hz);
  const { source, link } = useTelemetry(device.id, channelsFor(device, axis.index, shown), rateHz, KEEP_S);
  const stops = useStops({ device: device.id, axis: axis.index }, source, device.state === "connected");
  return (
    <LivePlots
      source={source}
      link={link}
      name={device.name}
      axis={axis.index}
      shown={shown}
      settings={null}
      stops={stops.data ?? []}
      choices={choices}
      onShown={(next) => setShown([...next])}
    />
  );
}
