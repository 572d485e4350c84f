import { Combobox, Kbd, Modal, TextInput, useCombobox } from "@mantine/core";
import { IconSearch } from "@tabler/icons-react";
import { useEffect, useState } from "react";
import type { Entry } from "./entries";
import classes from "./palette.module.css";
import { useChoose } from "./useChoose";
import { useFound } from "./useFound";

interface Props {
  opened: boolean;
  close: () => void;
}

/** A field to write into, and below it what fits. Nothing here moves a motor or writes into a device. */
export function PaletteDialog({ opened, close }: Props) {
  return (
    <Modal
      opened={opened}
      onClose={close}
      withCloseButton={false}
      title="Find"
      size="lg"
      padding={0}
      yOffset="calc(var(--shell-header-height) + 16px)"
      classNames={{ header: classes.header }}
    >
      {opened && <Find close={close} />}
    </Modal>
  );
}

function Find({ close }: { close: () => void }) {
  const [query, setQuery] = useState("");
  const list = useCombobox({ opened: true, onDropdownClose: close });
  const { entries, searched, recent, waiting } = useFound(query);
  const choose = useChoose();
  const shown = entries.map(({ id }) => id).join(" ");
  // biome-ignore lint/correctness/useExhaustiveDependencies: another list begins at its first, a newer look at it does not
  useEffect(() => {
    list.selectFirstOption();
  }, [query, shown]);

  function submit(id: string) {
    const entry = entries.find((one) => one.id === id);
    if (!entry || entry.off !== null) return;
    close();
    choose(entry);
  }

  return (
    <Combobox store={list} onOptionSubmit={submit}>
      <Combobox.EventsTarget withExpandedAttribute>
        <TextInput
          data-autofocus
          role="combobox"
          variant="unstyled"
          className={classes.query}
          aria-label="Find"
          placeholder="A page, register, field, axis, recording, profile, or a word of the help"
          leftSection={<IconSearch size={18} aria-hidden />}
          value={query}
          maxLength={100}
          onChange={(event) => setQuery(event.currentTarget.value)}
        />
      </Combobox.EventsTarget>
      <div className={classes.list}>
        <Combobox.Options aria-label="What fits" data-searched={searched}>
          {recent && entries.length > 0 && <div className={`${classes.group} hint`}>Last used</div>}
          {entries.map((entry) => (
            <Choice key={entry.id} entry={entry} />
          ))}
        </Combobox.Options>
        {entries.length === 0 && (
          <p className={`${classes.none} dim m-0`} role="status">
            {waiting
              ? "Looking…"
              : query.trim() === ""
                ? "Nothing was found before: begin to write"
                : `Nothing here is called "${query.trim()}"`}
          </p>
        )}
      </div>
      <div className={`${classes.keys} hint row gap-8`}>
        <span>
          <Kbd size="xs">↑</Kbd> <Kbd size="xs">↓</Kbd> choose
        </span>
        <span>
          <Kbd size="xs">Enter</Kbd> go there
        </span>
        <span>
          <Kbd size="xs">Ctrl K</Kbd> close
        </span>
      </div>
    </Combobox>
  );
}

function Choice({ entry }: { entry: Entry }) {
  return (
    <Combobox.Option value={entry.id} disabled={entry.off !== null} className={`${classes.choice} row gap-8`}>
      <span className={classes.title}>{entry.title}</span>
      <span className={`${classes.detail} dim grow`}>{entry.off ?? entry.detail}</span>
      <span className={`${classes.section} hint`}>{entry.section}</span>
    </Combobox.Option>
  );
}
