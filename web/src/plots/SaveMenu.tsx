import { Menu } from "@mantine/core";
import { type Subject, savePng, saveSvg } from "./picture";

/** What is asked for once the button of a picture is pressed: as pixels or as lines. */
export function SaveMenu({ subject, close }: { subject: () => Subject | null; close: () => void }) {
  const save = (as: (subject: Subject) => unknown) => () => {
    const now = subject();
    if (now !== null) void as(now);
  };
  return (
    <Menu opened onClose={close} position="bottom-end">
      <Menu.Target>
        <span />
      </Menu.Target>
      <Menu.Dropdown>
        <Menu.Item onClick={save(savePng)}>PNG, as it is seen</Menu.Item>
        <Menu.Item onClick={save(saveSvg)}>SVG, lines and text</Menu.Item>
      </Menu.Dropdown>
    </Menu>
  );
}
