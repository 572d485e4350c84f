import { ActionIcon } from "@mantine/core";
import { useDisclosure, useHotkeys } from "@mantine/hooks";
import { IconSearch } from "@tabler/icons-react";
import { useEffect, useState } from "react";
import { later } from "../../lib/later";

const PaletteDialog = later(() => import("./PaletteDialog").then((part) => part.PaletteDialog));

const OPEN = "stepscope:find";

/** Opens it from elsewhere: on a phone, whose header has no room for its button, from the bar of pages. */
export function openPalette() {
  window.dispatchEvent(new Event(OPEN));
}

/** Finds pages, axes, registers, recordings, profiles and help: on Ctrl K, wherever the focus is. */
export function Palette() {
  const [wanted, setWanted] = useState(false);
  const [opened, { open, close, toggle }] = useDisclosure(false, { onOpen: () => setWanted(true) });
  useHotkeys([["mod+K", toggle]], [], true);
  useEffect(() => {
    window.addEventListener(OPEN, open);
    return () => window.removeEventListener(OPEN, open);
  }, [open]);
  return (
    <>
      <ActionIcon
        aria-label="Find anything"
        aria-keyshortcuts="Control+K"
        title="Find anything (Ctrl K)"
        onClick={open}
        visibleFrom="sm"
      >
        <IconSearch size={18} />
      </ActionIcon>
      {wanted && <PaletteDialog opened={opened} close={close} />}
    </>
  );
}
