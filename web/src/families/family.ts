import type { IconActivity } from "@tabler/icons-react";
import type { ComponentType } from "react";
import type { Schemas } from "../api/client";
import type { Capability, Device } from "../api/queries";
import type { EmulatorPatch, EmulatorState } from "../pages/bench/useEmulator";

export interface PageEntry {
  path: string;
  label: string;
  /** for the bar of a phone */
  short: string;
  Icon: typeof IconActivity;
  /** where it stands in the navigation, by number */
  place: number;
  /** for devices that can one of these; none: for every one */
  needs: readonly Capability[];
  /** and not for those that can this */
  unless?: Capability;
  /** it says something without a device, too */
  alone: boolean;
  /** pages of one topic stand in for each other, where a device has another of them */
  topic: "settings" | "ramp" | "encoder" | "";
}

export interface FamilyPage extends PageEntry {
  load: () => Promise<{ default: ComponentType }>;
}

export type PageDetails = Partial<Pick<PageEntry, "needs" | "unless" | "alone" | "topic">>;

export function page(
  place: number,
  path: string,
  label: string,
  short: string,
  Icon: typeof IconActivity,
  more: PageDetails = {},
): PageEntry {
  return { place, path, label, short, Icon, needs: [], alone: false, topic: "", ...more };
}

export type Write = Schemas["RegisterBatchItem"];

/** The register of the highest velocity that an axis is set to. */
export interface TopRegister {
  name: string;
  /** pps of one unit of it; by the axis's dividers where none is said */
  pps?: (clockHz: number) => number;
  /** it cannot be read: it is asked for among what the server knows of this group */
  kept?: string;
}

export interface ControlsProps {
  device: Device;
  state: EmulatorState;
  /** whose motor is shown, where a chip has several */
  axis: number;
  onAxis: (axis: number) => void;
  send: (patch: EmulatorPatch) => void;
}

/** Fields of the currents of the microstep table, of the phase with its sine and of that with its cosine. */
export interface Phases {
  sine: string;
  cosine: string;
}

/** What a family of chips or modules has for itself, and how it does what every family does in its own way. */
export interface Family {
  pages: readonly FamilyPage[];
  /** the plant of an emulated one */
  Controls: ComponentType<ControlsProps>;
  /** null where no register says it */
  top: TopRegister | ((device: Device, axis: number) => TopRegister | null);
  /** writes that call the present position zero, while the motor stands and without moving it */
  zero: (device: Device, axis: number) => readonly Write[] | Promise<readonly Write[]>;
  /** the registers whose bits are its events; a model may lack some */
  events: readonly string[];
  /** names of events that are not called as their bit is, by the bit's name */
  eventNames?: Readonly<Record<string, string>>;
  /** which of the bits are told, where it is not all of them */
  eventsNeed?: string;
  /** what its data sheets call the phase that has the sine of a microstep table, and the one that has the cosine */
  phases?: Phases | ((model: string) => Phases);
}
