import { Modal } from "@mantine/core";
import { useShared } from "../shared";
import { StartUpPlan } from "./StartUpPlan";
import { type StartUpWanted, startUpWanted } from "./wanted";

/** The start-up that was asked for, before it is done. */
export function StartUpDialog() {
  const wanted = useShared(startUpWanted);
  const close = () => startUpWanted.set(null);
  return (
    <Modal
      opened={wanted !== null}
      onClose={close}
      title={wanted && titleOf(wanted)}
      size="lg"
      closeButtonProps={{ "aria-label": "Close" }}
      transitionProps={{ duration: 120 }}
    >
      {wanted && (
        <StartUpPlan {...wanted} body={{ axes: wanted.axes === null ? null : [...wanted.axes] }} close={close} />
      )}
    </Modal>
  );
}

function titleOf({ device, axes, axisNames }: StartUpWanted): string {
  return axes === null ? `Start up ${device}` : `Start up ${device}, ${named(axes, axisNames)}`;
}

function named(axes: readonly number[], names: readonly string[]): string {
  return axes.map((axis) => (names.length > 1 && names[axis]) || `axis ${axis}`).join(", ");
}
