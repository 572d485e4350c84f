import type { ComponentType } from "react";
import type { Capability, Device } from "../api/queries";
import { can } from "../api/queries";

/** What a panel is given. It shows `axis` of `device`: the selected one, or the one that it is pinned to. */
export interface PanelProps<C extends object = object> {
  id: string;
  config: C;
  change: (part: Partial<C>) => void;
  device: Device;
  axis: Device["axes"][number];
  devices: readonly Device[];
  /** the server does not answer: nobody knows how the devices are */
  lost: boolean;
}

/** The same for a panel that says something of a device without an axis, or without any device. */
export type LooseProps<C extends object = object> = Omit<PanelProps<C>, "device" | "axis"> & {
  device: Device | undefined;
  axis: Device["axes"][number] | undefined;
};

/** And for one that shows a device, with or without axes. */
export type DeviceProps<C extends object = object> = LooseProps<C> & { device: Device };

/** A kind of panel. Nothing of it is loaded before it is shown, but what the first page shows. */
export interface PanelType {
  type: string;
  title: string;
  /** of its config */
  version: number;
  /** a device has to be able to do one of these; none: every one fits */
  needs?: readonly Capability[];
  /** and to have an axis, or none of both */
  wants: "axis" | "device" | "nothing";
  /** its device has to be emulated */
  emulated?: true;
  /** the least room that it makes sense in [px] */
  min: readonly [width: number, height: number];
  /** one in a layout is enough */
  single?: true;
  /** it fills its room and scrolls in itself; others are scrolled as a whole */
  fills?: true;
  /** where it does not fit the device, nothing is in its place */
  quiet?: true;
  /** behind another tab it goes on: what loading it anew would lose is dear */
  keeps?: true;
  /** a config out of what a layout says, of this version or an older one. It never throws. */
  config: (raw: Readonly<Record<string, unknown>>, from: number) => object;
  Panel: ComponentType<LooseProps>;
}

type Row<C extends object, P> = Omit<PanelType, "config" | "Panel" | "wants"> & {
  config?: (raw: Readonly<Record<string, unknown>>, from: number) => C;
  Panel: ComponentType<P>;
};

const NO_CONFIG = () => ({});

/** A kind of panel that shows an axis. */
export function ofAxis<C extends object = object>(row: Row<C, PanelProps<C>>): PanelType {
  return { config: NO_CONFIG, ...row, wants: "axis", Panel: row.Panel as unknown as ComponentType<LooseProps> };
}

/** One that shows a device, with or without axes. */
export function ofDevice<C extends object = object>(row: Row<C, DeviceProps<C>>): PanelType {
  return { config: NO_CONFIG, ...row, wants: "device", Panel: row.Panel as unknown as ComponentType<LooseProps> };
}

/** One that needs neither. */
export function ofNothing<C extends object = object>(row: Row<C, LooseProps<C>>): PanelType {
  return { config: NO_CONFIG, ...row, wants: "nothing", Panel: row.Panel as unknown as ComponentType<LooseProps> };
}

/** Why a panel has nothing to show for a device; null where it has. */
export function misfit(type: PanelType, device: Device | undefined, axis: unknown): string | null {
  if (type.wants === "nothing") return null;
  if (device === undefined) return "No device is chosen.";
  if (type.emulated && !device.emulated) return `${device.name} is no emulated device.`;
  if (type.needs && !type.needs.some((need) => can(device, need))) return `A ${device.title} has nothing for it.`;
  return type.wants === "axis" && axis === undefined ? `${device.name} has no axis.` : null;
}
