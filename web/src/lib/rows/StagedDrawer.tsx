import { Drawer } from "@mantine/core";
import { useState } from "react";
import type { Device } from "../../api/queries";
import { ProblemAlert } from "../ProblemAlert";
import { ChangesPanel } from "./ChangesPanel";
import css from "./rows.module.css";
import { StagedBar } from "./StagedBar";
import type { ChipRows } from "./useChipRows";

/** What waits for a chip, on a page that is about one subject: the bar of the registers page, and its diff in a drawer. */
export function StagedDrawer({ chip, device }: { chip: ChipRows; device: Device }) {
  const [open, setOpen] = useState(false);
  const { staged, apply, count, live } = chip;
  const send = () =>
    apply.mutate(undefined, {
      onSuccess: ({ left }) => left > 0 && setOpen(true),
      onError: () => setOpen(true),
    });
  return (
    <div className={`${css.sticky} text-13`} data-staged={count > 0 || apply.error !== null}>
      <StagedBar
        count={count}
        staged={staged}
        busy={apply.isPending}
        canApply={live.connected}
        onReview={() => setOpen(true)}
        onDiscard={() => chip.discard(null)}
        onApply={send}
      />
      {apply.error !== null && !open && <ProblemAlert error={apply.error} doing="Writing registers" />}
      <Drawer
        opened={open}
        onClose={() => setOpen(false)}
        position="right"
        size="md"
        title={`Changes for ${device.name}`}
        closeButtonProps={{ "aria-label": "Close the changes" }}
      >
        <div className="text-13">
          <ChangesPanel
            what={{ one: "register", many: "registers" }}
            staged={staged}
            rows={chip.rows}
            readings={live.byKey}
            axisNames={device.axes.map((entry) => entry.name)}
            error={apply.error}
            busy={apply.isPending}
            canApply={live.connected}
            onApply={send}
            onDiscard={chip.discard}
          />
        </div>
      </Drawer>
    </div>
  );
}
