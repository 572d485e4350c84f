import { CloseButton, Popover } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { type ReactElement, useId } from "react";
import type { Device } from "../../api/queries";
import { useStanding } from "../../live/useStanding";
import { later } from "../later";
import { useAxisReading } from "./useAxisReading";

const ConditionDetail = later(() => import("./ConditionDetail").then((part) => part.ConditionDetail));

interface Props {
  device: Device;
  axis: Device["axes"][number];
  /** what opens it */
  target: (toggle: () => void, opened: boolean) => ReactElement;
}

/** Why an axis is as it is, behind whatever shows its condition in short. */
export function ConditionPopover({ device, axis, target }: Props) {
  const [opened, { toggle, close }] = useDisclosure();
  const standing = useStanding(device.id, axis.index);
  const read = useAxisReading(device.id, axis.index, opened && device.state === "connected");
  const title = useId();
  return (
    <Popover
      opened={opened}
      onDismiss={close}
      onClose={close}
      width={340}
      position="bottom-start"
      trapFocus
      withinPortal
    >
      <Popover.Target>{target(toggle, opened)}</Popover.Target>
      <Popover.Dropdown p="sm" aria-labelledby={title} data-testid="condition-detail">
        <div style={{ display: "flex", justifyContent: "space-between", alignItems: "center" }}>
          <b id={title}>
            {device.name} · {axis.name}
          </b>
          <CloseButton size="sm" aria-label="Close" onClick={close} />
        </div>
        <ConditionDetail standing={standing} read={read.data} />
      </Popover.Dropdown>
    </Popover>
  );
}
