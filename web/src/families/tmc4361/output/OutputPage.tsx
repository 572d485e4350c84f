import { IconBolt } from "@tabler/icons-react";
import type { Device } from "../../../api/queries";
import { NoDevice, Waiting } from "../../../lib/NoDevice";
import { Page } from "../../../lib/Page";
import { ChipNotices } from "../../../lib/rows/ChipNotices";
import { DeviceNotice } from "../../../lib/rows/DeviceNotice";
import { StagedDrawer } from "../../../lib/rows/StagedDrawer";
import { useChipRows } from "../../../lib/rows/useChipRows";
import { useSelectedAxis } from "../../../live/selection";
import { CurrentOverMove } from "./CurrentOverMove";
import { PwmSection } from "./PwmSection";
import { ScaleFields } from "./ScaleFields";

const GROUPS = ["general", "ramp", "clock", "current", "pwm", "microsteps"] as const;
const DEFAULT_CLOCK = 16e6;

/** What the coils get, by what the ramp does: current scales over a move, and the duty of PWM outputs. */
export default function OutputPage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  if (waiting) return <Waiting page="Drive currents" />;
  if (!device || !entry) return <NoDevice page="Drive currents" icon={<IconBolt size={22} />} wanted="a TMC4361" />;
  return <OfChip key={key} device={device} axis={entry} />;
}

function OfChip({ device, axis }: { device: Device; axis: Device["axes"][number] }) {
  const chip = useChipRows(device, axis.index, GROUPS);
  const connected = device.state === "connected";
  const clockHz = device.clock_hz ?? DEFAULT_CLOCK;
  return (
    <Page name="Drive currents">
      <DeviceNotice device={device} />
      <ChipNotices chip={chip} device={device} />
      <div className="columns side-left until-62" data-stale={!connected}>
        <ScaleFields chip={chip} clockHz={clockHz} disabled={!chip.known} />
        <div className="column ahead">
          <CurrentOverMove chip={chip} clockHz={clockHz} axis={axis} of={`${device.id}.${axis.index}`} />
          <PwmSection chip={chip} clockHz={clockHz} disabled={!chip.known} />
        </div>
      </div>
      <StagedDrawer chip={chip} device={device} />
    </Page>
  );
}
