import { ActionIcon } from "@mantine/core";
import { notifications } from "@mantine/notifications";
import { IconLink } from "@tabler/icons-react";

const TOAST = "link";

/** Copies the address of what is seen. Off this machine and without https no browser lets a page do that. */
export async function copyLink(): Promise<void> {
  notifications.hide(TOAST);
  try {
    await navigator.clipboard.writeText(location.href);
    notifications.show({ id: TOAST, message: "The link to this view is copied." });
  } catch {
    notifications.show({
      id: TOAST,
      title: "The browser does not let this page copy",
      message: `Copy it by hand: ${location.href}`,
      autoClose: false,
    });
  }
}

export function CopyLink() {
  return (
    <ActionIcon
      aria-label="Copy the link to this view"
      title="Copy the link to this view"
      onClick={() => void copyLink()}
      visibleFrom="sm"
    >
      <IconLink size={18} />
    </ActionIcon>
  );
}
