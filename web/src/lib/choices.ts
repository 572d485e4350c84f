import type { Device } from "../api/queries";

/** What to call each device, by its id: its name, with the id behind it where another device has the same one. */
export function namesOf(devices: readonly Device[]): ReadonlyMap<string, string> {
  const count = new Map<string, number>();
  for (const { name } of devices) count.set(name, (count.get(name) ?? 0) + 1);
  return new Map(devices.map(({ id, name }) => [id, count.get(name) === 1 ? name : `${name} (${id})`]));
}

/** Every axis of every device, and devices without any, as a Select takes them: its groups and labels have to differ. */
export function choicesOf(devices: readonly Device[]) {
  const names = namesOf(devices);
  return devices.map((device) => ({
    group: `${names.get(device.id)} · ${device.title}`,
    items: (device.axes.length > 0 ? device.axes : [{ index: 0, name: "registers only" }]).map((axis) => ({
      value: `${device.id}/${axis.index}`,
      label: `${names.get(device.id)} · ${axis.name}`,
    })),
  }));
}

/** Values with what to call them, as a Select or SegmentedControl takes them, in this order. */
export function optionsOf<Value extends string>(labels: Readonly<Record<Value, string>>) {
  return (Object.entries(labels) as [Value, string][]).map(([value, label]) => ({ value, label }));
}
