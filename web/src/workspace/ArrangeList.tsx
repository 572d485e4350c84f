import { ActionIcon, Button, Drawer, Group } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { IconArrowDown, IconArrowUp, IconLayoutDashboard, IconX } from "@tabler/icons-react";
import { useState } from "react";
import { AddMenu } from "./AddMenu";
import { closed, mayClose, moved } from "./edits";
import { LayoutMenu } from "./LayoutMenu";
import { type Layout, labelOf } from "./layout";
import { titleOf } from "./panels";

/** On a phone: the panels as a list, to be put up and down. Where they stand on a desktop stays as it is. */
export function ArrangeList({ layout }: { layout: Layout }) {
  const [opened, { open, close }] = useDisclosure();
  const [menu, setMenu] = useState(false);
  const { document, put } = layout;
  const { phone } = document.screens;
  return (
    <>
      <Group gap="xs" mt="sm" justify="center">
        <Button variant="default" leftSection={<IconLayoutDashboard size={16} aria-hidden />} onClick={open}>
          Arrange the panels
        </Button>
        <AddMenu layout={layout} />
        <LayoutMenu layout={layout} opened={menu} onChange={setMenu}>
          <Button variant="default" leftSection={<IconLayoutDashboard size={16} aria-hidden />}>
            {labelOf(layout)}
          </Button>
        </LayoutMenu>
      </Group>
      <Drawer
        opened={opened}
        onClose={close}
        position="bottom"
        title="Panels, from top to bottom"
        closeButtonProps={{ "aria-label": "Close" }}
      >
        <ol className="list grid gap-4">
          {phone.map((id, at) => {
            const title = titleOf(document, id);
            const go = (by: -1 | 1) =>
              put(moved(document, id, by), `${title} is number ${at + 1 + by} of ${phone.length}`);
            return (
              <li key={id} className="row gap-4 box pad-s">
                <span className="grow text-14">{title}</span>
                <ActionIcon size="lg" aria-label={`${title} up`} disabled={at === 0} onClick={() => go(-1)}>
                  <IconArrowUp size={18} />
                </ActionIcon>
                <ActionIcon
                  size="lg"
                  aria-label={`${title} down`}
                  disabled={at === phone.length - 1}
                  onClick={() => go(1)}
                >
                  <IconArrowDown size={18} />
                </ActionIcon>
                <ActionIcon
                  size="lg"
                  aria-label={`Close ${title}`}
                  disabled={!mayClose(document, id)}
                  onClick={() => put(closed(document, id), `${title} is closed`)}
                >
                  <IconX size={18} />
                </ActionIcon>
              </li>
            );
          })}
        </ol>
      </Drawer>
    </>
  );
}
