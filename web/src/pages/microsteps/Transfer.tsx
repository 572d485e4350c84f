import { Button, CopyButton, Modal, Stack, Text, Textarea } from "@mantine/core";
import { IconClipboardText, IconCopy } from "@tabler/icons-react";
import { useState } from "react";
import { cArray, hexList, parseTable } from "./table";

interface Props {
  values: readonly number[] | null;
  onPaste: (values: number[]) => void;
}

export function Copy({ label, text }: { label: string; text: string }) {
  return (
    <CopyButton value={text} timeout={1500}>
      {({ copied, copy }) => (
        <Button
          size="compact-xs"
          variant="default"
          leftSection={<IconCopy size={13} aria-hidden />}
          disabled={text === ""}
          onClick={copy}
        >
          <span aria-live="polite">{copied ? "Copied" : label}</span>
        </Button>
      )}
    </CopyButton>
  );
}

/** Out of the page as datagrams or C, into it as 64 numbers. */
export function Transfer({ values, onPaste }: Props) {
  const [open, setOpen] = useState(false);
  const [text, setText] = useState("");
  const parsed = parseTable(text);
  const wrong = "wrong" in parsed ? parsed.wrong : null;

  function take() {
    if ("wrong" in parsed) return;
    onPaste(parsed.values);
    setOpen(false);
    setText("");
  }

  return (
    <>
      <Copy label="Datagrams" text={values ? hexList(values) : ""} />
      <Copy label="C array" text={values ? cArray(values) : ""} />
      <Button
        size="compact-xs"
        variant="default"
        leftSection={<IconClipboardText size={13} aria-hidden />}
        onClick={() => setOpen(true)}
      >
        Paste
      </Button>
      <Modal opened={open} onClose={() => setOpen(false)} title="Paste a table" size="lg">
        <Stack gap="sm">
          <Text size="sm" c="dimmed">
            64 numbers of 0 to 63, separated by spaces, commas or lines; a C array; or the 32 datagrams.
          </Text>
          <Textarea
            aria-label="Table as text"
            autosize
            minRows={8}
            maxRows={16}
            value={text}
            data-autofocus
            error={text.trim() !== "" && wrong}
            classNames={{ input: "num" }}
            onChange={(event) => setText(event.currentTarget.value)}
          />
          <Button size="sm" onClick={take} disabled={wrong !== null}>
            Use these values
          </Button>
        </Stack>
      </Modal>
    </>
  );
}
