import { ActionIcon } from "@mantine/core";
import { IconLogout } from "@tabler/icons-react";
import { logOut, useAccess } from "../api/access";

/** The way out, for whoever came in with a token. On a phone it is on the page Health alone: the stop needs the room. */
export function LogOut() {
  const access = useAccess();
  if (access?.by !== "session") return null;
  const who = `Log out${access.name === null ? "" : ` ${access.name}`} (role: ${access.role})`;
  return (
    <ActionIcon aria-label={who} title={who} visibleFrom="sm" onClick={() => void logOut()}>
      <IconLogout size={18} />
    </ActionIcon>
  );
}
