import { useCallback, useEffect } from "react";
import { useLocation } from "wouter";
import { type Device, useDevices } from "../api/queries";
import { putIntoAddress, useAddress } from "../lib/address";
import { useLocalKept } from "../lib/useKept";

interface Chosen {
  device: string;
  axis: number;
}

export interface Selection {
  device: Device | undefined;
  axis: number;
  select: (device: string, axis: number) => void;
}

const textsOf = ({ device, axis }: Chosen) => ({ d: device, a: axis === 0 ? "" : String(axis) });

/** Of this tab: what its address said on the page before. Tabs show axes of their own. */
let here: Chosen | null = null;

/** What is chosen: by the address, else on the page before, else in whichever tab was the last to choose. */
function useChosen() {
  const { d, a } = useAddress("d", "a");
  const [last, keep] = useLocalKept<Chosen>("stepscope.selection", { device: "", axis: 0 });
  const chosen = d === "" ? (here ?? last) : { device: d, axis: /^\d{1,3}$/.test(a) ? Number(a) : 0 };
  return { chosen, addressed: d !== "", keep };
}

/** The device and axis that every page works on, by the address; the first device where that one is gone. */
export function useSelection(): Selection {
  const devices = useDevices();
  const { chosen, keep } = useChosen();
  const device = devices.data?.find((candidate) => candidate.id === chosen.device) ?? devices.data?.[0];
  const axis = device && chosen.device === device.id && chosen.axis < device.axes.length ? chosen.axis : 0;
  const select = useCallback(
    (id: string, index: number) => {
      here = { device: id, axis: index };
      keep(here);
      putIntoAddress(textsOf(here), "step");
    },
    [keep],
  );
  return { device, axis, select };
}

/** Puts what is chosen into the address of each page that is gone to without. */
export function useSelectionInAddress(): void {
  const [path] = useLocation();
  const { chosen, addressed } = useChosen();
  const { device, axis } = useSelection();
  const of = addressed || chosen.device !== "" ? chosen : device ? { device: device.id, axis } : null;
  // biome-ignore lint/correctness/useExhaustiveDependencies: each page has an address of its own
  useEffect(() => {
    if (of === null) return;
    here = { device: of.device, axis: of.axis };
    if (!addressed) putIntoAddress(textsOf(of), "replace");
  }, [path, addressed, of?.device, of?.axis]);
}

/** The selected axis, and its device, which counts as disconnected while the server does not answer. */
export function useSelectedAxis() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  const known: Device | undefined = device && devices.isError ? { ...device, state: "disconnected" } : device;
  return {
    /** nobody knows yet which devices there are */
    waiting: devices.data === undefined && !devices.isError,
    device: known,
    entry: known?.axes.find(({ index }) => index === axis),
    key: `${device?.id}/${axis}`,
  };
}
