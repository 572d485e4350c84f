import { IconPlayerPlay } from "@tabler/icons-react";
import type { Device } from "../../../api/queries";
import { NoDevice, Waiting } from "../../../lib/NoDevice";
import { Page } from "../../../lib/Page";
import { ChipNotices } from "../../../lib/rows/ChipNotices";
import { DeviceNotice } from "../../../lib/rows/DeviceNotice";
import { StagedDrawer } from "../../../lib/rows/StagedDrawer";
import { useChipRows } from "../../../lib/rows/useChipRows";
import { useSelectedAxis } from "../../../live/selection";
import { SequenceSection } from "./SequenceSection";
import { StartSection } from "./StartSection";
import { StepSection } from "./StepSection";

const GROUPS = ["general", "start", "step/dir", "ramp", "pipeline", "shadow"] as const;
const DEFAULT_CLOCK = 16e6;

/** What gives a start and what waits for one, sequences of targets; steps that come from outside, and what they become. */
export default function StartPage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  if (waiting) return <Waiting page="Start and steps" />;
  if (!device || !entry)
    return <NoDevice page="Start and steps" icon={<IconPlayerPlay size={22} />} wanted="a chip with a START pin" />;
  return <OfChip key={key} device={device} axis={entry} />;
}

function OfChip({ device, axis }: { device: Device; axis: Device["axes"][number] }) {
  const chip = useChipRows(device, axis.index, GROUPS);
  const clockHz = device.clock_hz ?? DEFAULT_CLOCK;
  const connected = device.state === "connected";
  const common = { chip, device, clockHz, disabled: !chip.known };
  return (
    <Page name="Start and steps">
      <DeviceNotice device={device} />
      <ChipNotices chip={chip} device={device} />
      <div className="columns until-75" data-stale={!connected}>
        <StartSection {...common} />
        <StepSection {...common} microsteps={axis.microsteps_per_full_step} fullSteps={axis.full_steps_per_rev} />
      </div>
      <SequenceSection chip={chip} clockHz={clockHz} disabled={!chip.known || !connected} />
      <StagedDrawer chip={chip} device={device} />
    </Page>
  );
}
