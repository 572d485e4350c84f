import type { Device } from "../../api/queries";
import { ProblemAlert } from "../ProblemAlert";
import type { ChipRows } from "./useChipRows";

/** Why the register list, or values of a connected device, are not there. */
export function ChipNotices({ chip, device }: { chip: ChipRows; device: Device }) {
  const { catalog, readings } = chip.live;
  return (
    <>
      {catalog.isError && (
        <ProblemAlert error={catalog.error} doing="Reading the register list" retry={() => void catalog.refetch()} />
      )}
      {readings.isError && device.state === "connected" && (
        <ProblemAlert error={readings.error} doing={`Reading ${device.name}`} retry={() => void readings.refetch()} />
      )}
    </>
  );
}
