import { Select } from "@mantine/core";
import { useDevices } from "../api/queries";
import { useSelection } from "../live/selection";

/** Which axis the pages show. */
export function DevicePicker() {
  const devices = useDevices();
  const { device, axis, select } = useSelection();
  const groups = (devices.data ?? []).map((candidate) => ({
    group: `${candidate.name} · ${candidate.title}`,
    items: candidate.axes.map((entry) => ({
      value: `${candidate.id}/${entry.index}`,
      label: `${candidate.name} ${entry.name}`,
    })),
  }));
  return (
    <Select
      aria-label="Device and axis"
      data={groups}
      value={device ? `${device.id}/${axis}` : null}
      placeholder={devices.isPending ? "Looking for devices" : "No device"}
      allowDeselect={false}
      size="xs"
      w={{ base: 140, sm: 220 }}
      onChange={(value) => {
        const [id, index] = value?.split("/") ?? [];
        if (id !== undefined && index !== undefined) select(id, Number(index));
      }}
    />
  );
}
