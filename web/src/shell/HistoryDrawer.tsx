import { Drawer } from "@mantine/core";
import { useDevices } from "../api/queries";
import type { Aim } from "../lib/history/aim";
import { HistoryPanel } from "../lib/history/HistoryPanel";
import { useSelection } from "../live/selection";

interface Props {
  opened: boolean;
  close: () => void;
  aim: Aim | null;
}

/** The history beside any page. */
export function HistoryDrawer({ opened, close, aim }: Props) {
  const { device } = useSelection();
  const devices = useDevices();
  const about = aim === null ? device : devices.data?.find(({ id }) => id === aim.device);
  return (
    <Drawer
      opened={opened}
      onClose={close}
      position="right"
      size="md"
      title="History"
      closeButtonProps={{ "aria-label": "Close the history" }}
    >
      {opened && <HistoryPanel device={about} aim={aim} />}
    </Drawer>
  );
}
