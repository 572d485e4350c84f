import { Text } from "@mantine/core";
import type { Schemas } from "../../../api/client";
import type { Device } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { ChipField } from "../../../lib/rows/ChipField";
import { StagedDrawer } from "../../../lib/rows/StagedDrawer";
import { useChipRows } from "../../../lib/rows/useChipRows";
import { WarningList } from "../../../lib/Warnings";
import { useEmulator } from "../../../pages/bench/useEmulator";
import { selectNotes } from "./selects";

const REGISTER = "stepper_motor_global_parameter_register";
const GROUPS = ["global"] as const;

/** One chip select for the chain, or one for each driver. */
export function ChipSelects({ device, lengths }: { device: Device; lengths: readonly number[] }) {
  const chip = useChipRows(device, 0, GROUPS);
  const emulator = useEmulator(device);
  const at = { chip, disabled: !chip.known };
  const state = emulator.data as Schemas["EmulatorState"] | undefined;
  const notes = selectNotes({
    individual: chip.planned(REGISTER, "csCommonIndividual"),
    polarity: chip.planned(REGISTER, "polarity_nscs_s"),
    refmux: chip.planned(REGISTER, "refmux"),
    board: state?.chip_selects ?? null,
    lengths,
  });
  return (
    <Card title="Chip selects" note="how drivers are selected, by chip and board alike">
      <div className="halves start gap-8">
        <ChipField {...at} register={REGISTER} field="csCommonIndividual" />
        <ChipField {...at} register={REGISTER} field="polarity_nscs_s" />
      </div>
      {state && (
        <Text className="hint mt-4">
          The emulated board is wired for {state.chip_selects === "individual" ? "three selects" : "one select"}.
        </Text>
      )}
      <WarningList texts={notes} data-testid="select-notes" />
      <StagedDrawer chip={chip} device={device} />
    </Card>
  );
}
