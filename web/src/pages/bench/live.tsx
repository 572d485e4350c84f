import { createContext, type PropsWithChildren, useContext, useMemo } from "react";
import { type Device, useDevices } from "../../api/queries";
import type { TelemetryRequest } from "../../live/request";
import type { TelemetrySource } from "../../live/TelemetrySource";
import { useTelemetries } from "../../live/useTelemetry";

/** What the page shows of every axis, whether it is on the scope or not. */
const QUANTITIES = ["position", "velocity", "position_reached", "switch_left", "switch_right", "switch_home"] as const;
/** Chips call their third switch the reference switch, modules the home switch: it is one on the page. */
const CHIP_HOME = "switch_reference";
const RATE_HZ = 30;
/** Enough to find the position at the time of an emulator's answer, which comes by another way. */
const KEEP_S = 4;

const Sources = createContext<readonly TelemetrySource[]>([]);

function requestFor(device: Device): TelemetryRequest[] {
  const channels = device.channels
    .filter((channel) => [...QUANTITIES, CHIP_HOME].some((quantity) => quantity === channel.quantity))
    .map((channel) => channel.name);
  if (device.state !== "connected" || channels.length === 0) return [];
  return [{ device: device.id, channels, rateHz: Math.min(RATE_HZ, device.rate_max_hz), keepS: KEEP_S }];
}

/** The state of all axes of all connected devices, live: a slow wish of each device. */
export function BenchLive({ children }: PropsWithChildren) {
  const devices = useDevices();
  const requests = useMemo(() => (devices.data ?? []).flatMap(requestFor), [devices.data]);
  const sources = useTelemetries(requests);
  return <Sources value={sources}>{children}</Sources>;
}

export type AxisQuantity = (typeof QUANTITIES)[number];

export interface LiveAxis {
  source: TelemetrySource | undefined;
  /** the newest value, NaN while there is none */
  read: (quantity: AxisQuantity) => number;
  /** the value of a row of the buffer, NaN where there is none */
  at: (quantity: AxisQuantity, row: number) => number;
  moving: () => boolean;
}

/** The live state of one axis; read it in an animation frame or a LiveText. */
export function useLiveAxis(device: string, axis: number): LiveAxis {
  const sources = useContext(Sources);
  return useMemo(() => {
    const source = sources.find((candidate) => candidate.request.device === device);
    const nameOf = (quantity: AxisQuantity) =>
      quantity === "switch_home" && !source?.request.channels.includes(`switch_home.${axis}`)
        ? `${CHIP_HOME}.${axis}`
        : `${quantity}.${axis}`;
    const read = (quantity: AxisQuantity) => source?.buffer.last(nameOf(quantity)) ?? Number.NaN;
    const at = (quantity: AxisQuantity, row: number) => source?.buffer.column(nameOf(quantity))?.[row] ?? Number.NaN;
    return { source, read, at, moving: () => Math.abs(read("velocity")) > 0 };
  }, [sources, device, axis]);
}
