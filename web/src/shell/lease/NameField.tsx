import { TextInput } from "@mantine/core";
import { useState } from "react";
import { LONGEST_NAME, saveName, userName } from "../../api/lease/session";

interface Props {
  /** the name was changed */
  onSaved?: () => void;
}

/** What the others see; kept in this browser. Taken with Enter, or when the field is left. */
export function NameField({ onSaved }: Props) {
  const [name, setName] = useState(userName);
  const save = () => {
    if (name.trim() === userName()) return;
    saveName(name);
    setName(userName());
    onSaved?.();
  };
  return (
    <TextInput
      label="Your name, for the others"
      value={name}
      maxLength={LONGEST_NAME}
      autoComplete="nickname"
      onChange={(event) => setName(event.currentTarget.value)}
      onBlur={save}
      onKeyDown={(event) => event.key === "Enter" && save()}
    />
  );
}
