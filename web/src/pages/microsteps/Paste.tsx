import { Button, CopyButton, Modal, Stack, Text, Textarea } from "@mantine/core";
import { IconClipboardText, IconCopy } from "@tabler/icons-react";
import { useState } from "react";

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

interface Props<Read> {
  /** what is pasted: "wave" */
  what: string;
  /** what text may say it */
  help: string;
  use: string;
  parse: (text: string) => Read | { wrong: string };
  onPaste: (read: Read) => void;
}

/** A button and its dialog: numbers in from text. */
export function Paste<Read extends object>({ what, help, use, parse, onPaste }: Props<Read>) {
  const [open, setOpen] = useState(false);
  const [text, setText] = useState("");
  const parsed = parse(text);
  const wrong = "wrong" in parsed ? parsed.wrong : null;

  function take() {
    if ("wrong" in parsed) return;
    onPaste(parsed);
    setOpen(false);
    setText("");
  }

  return (
    <>
      <Button
        size="compact-xs"
        variant="default"
        leftSection={<IconClipboardText size={13} aria-hidden />}
        onClick={() => setOpen(true)}
      >
        Paste
      </Button>
      <Modal opened={open} onClose={() => setOpen(false)} title={`Paste a ${what}`} size="lg">
        <Stack gap="sm">
          <Text size="sm" c="dimmed">
            {help}
          </Text>
          <Textarea
            aria-label={`${what.charAt(0).toUpperCase()}${what.slice(1)} as text`}
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
            {use}
          </Button>
        </Stack>
      </Modal>
    </>
  );
}
