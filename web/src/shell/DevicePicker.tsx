import { type Device, useDevices } from "../api/queries";
import { Choice } from "../lib/Choice";
import { choicesOf } from "../lib/choices";
import { StateDot } from "../lib/StateDot";
import { useSelection } from "../live/selection";

/** Which axis the pages show. */
export function DevicePicker() {
  const devices = useDevices();
  const { device, axis, select } = useSelection();
  // without a server nobody knows how the devices are
  const list = (devices.data ?? []).map((each) =>
    devices.isError ? { ...each, state: "disconnected" as const } : each,
  );
  const stateOf = (value: string): Device["state"] =>
    list.find((candidate) => candidate.id === value.split("/")[0])?.state ?? "disconnected";
  return (
    <Choice
      aria-label="Device and axis"
      data={choicesOf(list)}
      value={device ? `${device.id}/${axis}` : null}
      placeholder={devices.isPending ? "Looking for devices" : "No device"}
      empty={
        devices.data === undefined
          ? "Which devices there are is not known yet."
          : "No device yet: add one under Connections."
      }
      w={{ base: 150, xs: 200, sm: 240 }}
      leftSection={device && <StateDot state={devices.isError ? "disconnected" : device.state} />}
      mark={(value) => <StateDot state={stateOf(value)} />}
      onChange={(value) => {
        const [id, index] = value.split("/");
        if (id !== undefined && index !== undefined) select(id, Number(index));
      }}
    />
  );
}
