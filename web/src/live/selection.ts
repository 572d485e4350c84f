import { type Device, useDevices } from "../api/queries";
import { useLocalKept } from "../lib/useKept";

interface Stored {
  device: string;
  axis: number;
}

export interface Selection {
  device: Device | undefined;
  axis: number;
  select: (device: string, axis: number) => void;
}

/** The device and axis that every page works on; kept in the browser, the first device where that one is gone. */
export function useSelection(): Selection {
  const devices = useDevices();
  const [stored, setStored] = useLocalKept<Stored>("stepscope.selection", { device: "", axis: 0 });
  const device = devices.data?.find((candidate) => candidate.id === stored.device) ?? devices.data?.[0];
  const axis = device && stored.device === device.id && stored.axis < device.axes.length ? stored.axis : 0;
  return { device, axis, select: (id, index) => setStored({ device: id, axis: index }) };
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
