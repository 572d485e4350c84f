import type { Model } from "../api/queries";
import type { Family } from "./family";
import { listed } from "./listed/family";
import { tmc5xxx } from "./tmc5xxx/family";
import { tmc428 } from "./tmc428/family";
import { tmc4361 } from "./tmc4361/family";
import { tmcdrivers } from "./tmcdrivers/family";
import { tmcl } from "./tmcl/family";

/** What each family has of its own, by the name that the catalog has for it: one line a family. */
export const FAMILIES: Readonly<Record<string, Family>> = {
  tmc428,
  tmc4361,
  tmc5xxx,
  tmcdrivers,
  tmcl,
  listed,
};

/** Of the family of a device; undefined where this page has nothing of its own for it. */
export function familyOf(device: { about: Model } | undefined): Family | undefined {
  return device && FAMILIES[device.about.family];
}
