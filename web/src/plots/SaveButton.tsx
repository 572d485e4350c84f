import { ActionIcon } from "@mantine/core";
import { IconDownload } from "@tabler/icons-react";
import { useState } from "react";
import { later } from "../lib/later";
import classes from "./Plot.module.css";
import type { Subject } from "./picture";

const SaveMenu = later(() => import("./SaveMenu").then((part) => part.SaveMenu));

interface Props {
  name: string;
  subject: () => Subject | null;
  /** in the lower corner: the upper one is drawn in */
  low?: boolean | undefined;
}

/** In the corner of a picture that is pointed at: saves it as PNG or SVG. */
export function SaveButton({ name, subject, low }: Props) {
  const [opened, setOpened] = useState(false);
  return (
    <span className={classes.save} data-opened={opened} data-low={low}>
      <ActionIcon
        size={22}
        variant="default"
        aria-label={`Save a picture: ${name}`}
        aria-haspopup="menu"
        onClick={() => setOpened(true)}
      >
        <IconDownload size={14} />
      </ActionIcon>
      {opened && <SaveMenu subject={subject} close={() => setOpened(false)} />}
    </span>
  );
}
