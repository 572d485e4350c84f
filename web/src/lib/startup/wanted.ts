import { Shared } from "../shared";

/** The start-up that the user has asked for: its dialog outlives the button, which may go with what it has cured. */
export interface StartUpWanted {
  device: string;
  /** null for all axes */
  axes: readonly number[] | null;
  /** names of all axes of the device, where they are known */
  axisNames: readonly string[];
  onDone?: (() => void) | undefined;
}

export const startUpWanted = new Shared<StartUpWanted | null>(null);
