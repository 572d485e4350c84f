import { Kbd, Modal, Table, Text } from "@mantine/core";

const KEYS: readonly (readonly [string, readonly [keys: string, what: string][]])[] = [
  [
    "Everywhere",
    [
      ["Esc", "Stop all axes of all devices while one moves, or may. While all stand: close what is open"],
      ["Ctrl K", "Find a page, register, field, axis, recording, profile, or a word of the help"],
      [
        "Ctrl Z",
        "Undo a design or a staged edit; of what was written into a device, a preview. In a text, the text's own",
      ],
      ["Ctrl Shift Z", "Redo"],
      ["?", "This list"],
      ["F6 Shift F6", "On the bench: to the next panel, or back"],
      ["Alt 1 … 9", "Go to a page, in the order of the menu"],
    ],
  ],
  [
    "Jog buttons, when one has the focus",
    [
      ["← →", "Move while held, stop on release"],
      ["Space", "Move in the button's direction while held"],
    ],
  ],
  [
    "Scope",
    [
      ["P", "Pause and run"],
      ["T", "Trigger: roll, auto, single"],
      ["C", "Measuring cursors"],
    ],
  ],
  [
    "Any plot with the focus",
    [
      ["← →", "Move the cursor; with Shift farther"],
      ["+ −", "Zoom"],
      ["Page ↑ Page ↓", "Pan"],
      ["0", "Show all, or follow the signal again"],
      ["Wheel", "Zoom; with Shift pan"],
      ["Drag", "Zoom into a stretch; with Shift pan"],
    ],
  ],
  [
    "Program",
    [
      ["F5", "Run; by single steps where there are breakpoints"],
      ["F6 Shift F5", "Pause; stop the program"],
      ["F11 F10", "One command; over a subroutine"],
      ["Shift F11", "Out of the subroutine"],
      ["Ctrl F10", "Run to the cursor"],
      ["F9", "A breakpoint in the cursor's line"],
      ["Ctrl S", "Download"],
      ["Tab", "Leave the text; Ctrl ] and Ctrl [ indent"],
    ],
  ],
  [
    "Number fields",
    [
      ["↑ ↓", "Change by one step; with Shift by ten"],
      ["Enter", "Take the value"],
    ],
  ],
];

interface Props {
  opened: boolean;
  close: () => void;
}

/** Every key, by where it works. */
export function ShortcutsDialog({ opened, close }: Props) {
  return (
    <Modal opened={opened} onClose={close} title="Keyboard" size="md" closeButtonProps={{ "aria-label": "Close" }}>
      {KEYS.map(([group, keys]) => (
        <div key={group}>
          <Text size="xs" fw={600} c="dimmed" mt="sm" mb={2}>
            {group}
          </Text>
          <Table verticalSpacing={4} withRowBorders={false}>
            <Table.Tbody>
              {keys.map(([key, what]) => (
                <Table.Tr key={key}>
                  <Table.Td w={130}>
                    <Kbd>{key}</Kbd>
                  </Table.Td>
                  <Table.Td>{what}</Table.Td>
                </Table.Tr>
              ))}
            </Table.Tbody>
          </Table>
        </div>
      ))}
    </Modal>
  );
}
