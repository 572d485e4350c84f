import { ActionIcon } from "@mantine/core";
import { useDisclosure, useHotkeys } from "@mantine/hooks";
import { IconKeyboard } from "@tabler/icons-react";
import { useState } from "react";
import { later } from "../lib/later";

const ShortcutsDialog = later(() => import("./ShortcutsDialog").then((part) => part.ShortcutsDialog));

/** The list of keys, on "?". */
export function Shortcuts() {
  const [wanted, setWanted] = useState(false);
  const [opened, { open, close }] = useDisclosure(false, { onOpen: () => setWanted(true) });
  useHotkeys([
    ["shift+?", open],
    ["?", open],
  ]);
  return (
    <>
      <ActionIcon aria-label="Keyboard shortcuts" aria-keyshortcuts="?" onClick={open} visibleFrom="sm">
        <IconKeyboard size={18} />
      </ActionIcon>
      {wanted && <ShortcutsDialog opened={opened} close={close} />}
    </>
  );
}
