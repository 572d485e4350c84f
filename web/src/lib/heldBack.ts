import type { Device } from "../api/queries";

export const DOWNLOAD_MODE = "/problems/download-mode";
const OTHER_MODEL = "/problems/other-model";

/** Whether the link works and the driver keeps still all the same: what its user sends by hand still goes out. */
export function inDownloadMode(device: Device): boolean {
  return device.problem?.type === DOWNLOAD_MODE;
}

/** Models that really may be at the end of the link, where another one answers than the connection says. */
export function modelsFound(device: Device): Device["model"][] | null {
  if (device.problem?.type !== OTHER_MODEL) return null;
  const found = device.problem.facts.found;
  return Array.isArray(found) ? (found as Device["model"][]) : [];
}
