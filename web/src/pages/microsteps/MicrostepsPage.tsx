import { Button, SegmentedControl, Text } from "@mantine/core";
import { IconWaveSine } from "@tabler/icons-react";
import { can, type Device, useDevices } from "../../api/queries";
import { optionsOf } from "../../lib/choices";
import { EmptyState } from "../../lib/EmptyState";
import { useWhoCan } from "../../lib/models";
import { Page } from "../../lib/Page";
import { useLocalKept } from "../../lib/useKept";
import { usePhone } from "../../lib/usePhone";
import { useSelection } from "../../live/selection";
import { MslutEditor } from "./mslut/MslutEditor";
import { QuarterEditor } from "./QuarterEditor";

type Format = "quarter" | "mslut";

/** Which table is designed while no chip decides. */
function FormatChoice({ format, onFormat }: { format: Format; onFormat: (format: Format) => void }) {
  const [quarter, mslut] = [useWhoCan("microsteps.ram"), useWhoCan("microsteps.mslut")];
  const phone = usePhone();
  return (
    <div className="mid lines-8">
      <span className="hint m-0 mt-4">Design without a device, for</span>
      <SegmentedControl
        aria-label="Kind of table"
        orientation={phone ? "vertical" : "horizontal"}
        value={format}
        onChange={(next) => onFormat(next as Format)}
        data={optionsOf({
          quarter: `${quarter.join(", ")}, 64 values`,
          mslut: `${mslut.join(", ")}, 256 differences`,
        })}
      />
    </div>
  );
}

/** What to do where there is no table to design. */
function NoTable({
  device,
  others,
  onOther,
}: {
  device: Device;
  others: readonly Device[];
  onOther: (other: Device) => void;
}) {
  return (
    <EmptyState title={`${device.name} has no microstep table`} icon={<IconWaveSine size={24} />}>
      <Text size="sm" maw={560}>
        The {device.title} gives out step and direction; the currents of the microsteps are made by the driver behind
        it. Its resolution is set there (now {device.axes[0]?.driver_microsteps ?? 16} microsteps per full step, under
        Connections), and its wave, where it can be changed, in the driver's own table.
      </Text>
      {others.slice(0, 3).map((other) => (
        <Button key={other.id} onClick={() => onOther(other)}>
          Show the {other.title} {other.name}
        </Button>
      ))}
      {others.length === 0 && <Text size="sm">Add a chip that has one under Connections to design a table.</Text>}
    </EmptyState>
  );
}

/** Microsteps: the wave of a chip's table, what it does to the currents, and the way into the chip. */
export default function MicrostepsPage() {
  const devices = useDevices();
  const { device, axis, select } = useSelection();
  const [wanted, setWanted] = useLocalKept<Format>("stepscope.microsteps.format", "quarter");
  if (devices.isPending) return null;
  if (device && can(device, "step_dir")) {
    const others =
      devices.data?.filter((other) => can(other, "microsteps.ram") || can(other, "microsteps.mslut")) ?? [];
    return (
      <Page name="Microsteps">
        <NoTable device={device} others={others} onOther={(other) => select(other.id, 0)} />
      </Page>
    );
  }
  const format: Format = device === undefined ? wanted : can(device, "microsteps.mslut") ? "mslut" : "quarter";
  const Editor = format === "mslut" ? MslutEditor : QuarterEditor;
  return (
    <Editor
      key={device?.id ?? "-"}
      device={device}
      axis={axis}
      choice={device === undefined && <FormatChoice format={wanted} onFormat={setWanted} />}
    />
  );
}
