import { ActionIcon } from "@mantine/core";
import { IconMoon, IconSun } from "@tabler/icons-react";
import { useState } from "react";
import { later } from "../lib/later";
import { useScheme } from "../lib/useScheme";

const LookMenu = later(() => import("./LookMenu").then((part) => part.LookMenu));

/** Opens the menu of what the page looks like here. */
export function LookButton() {
  const [opened, setOpened] = useState(false);
  return (
    <span>
      <ActionIcon aria-label="Colours, density, times" aria-haspopup="menu" onClick={() => setOpened(true)}>
        {useScheme() === "light" ? <IconSun size={18} /> : <IconMoon size={18} />}
      </ActionIcon>
      {opened && <LookMenu close={() => setOpened(false)} />}
    </span>
  );
}
