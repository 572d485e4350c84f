import { Commands } from "../../pages/console/ConsolePage";
import { FrameLog } from "../../pages/console/FrameLog";
import type { DeviceProps } from "../panel";

/** What goes over the wire. */
export function FramesPanel({ device }: DeviceProps) {
  return <FrameLog key={device.id} device={device} />;
}

/** What the device is told word by word. */
export function ConsolePanel({ device }: DeviceProps) {
  return <Commands key={device.id} device={device} />;
}
