import { Button, Group, Modal, TextInput } from "@mantine/core";
import { useState } from "react";

interface Props {
  opened: boolean;
  title: string;
  name: string;
  close: () => void;
  done: (name: string) => void;
}

/** Asks for a name. */
export function NameDialog({ opened, title, name, close, done }: Props) {
  return (
    <Modal opened={opened} onClose={close} title={title} size="sm" closeButtonProps={{ "aria-label": "Close" }}>
      {opened && <Asked name={name} close={close} done={done} />}
    </Modal>
  );
}

function Asked({ name, close, done }: Pick<Props, "name" | "close" | "done">) {
  const [text, setText] = useState(name);
  const plain = text.trim();
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        if (plain === "") return;
        close();
        done(plain);
      }}
    >
      <TextInput
        data-autofocus
        label="Name"
        value={text}
        maxLength={80}
        onChange={(event) => setText(event.currentTarget.value)}
      />
      <Group justify="end" mt="sm">
        <Button variant="default" onClick={close}>
          Cancel
        </Button>
        <Button type="submit" disabled={plain === ""}>
          OK
        </Button>
      </Group>
    </form>
  );
}
