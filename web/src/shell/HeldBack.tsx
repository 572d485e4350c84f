import { useDevices } from "../api/queries";
import { later } from "../lib/later";

const Held = later(() => import("./Held").then((part) => part.Held));

/** Above every page: devices that are left alone although they answer, why, and the way out as a button. */
export function HeldBack() {
  const devices = useDevices();
  return devices.data?.filter(({ heldBack }) => heldBack).map((device) => <Held key={device.id} device={device} />);
}
