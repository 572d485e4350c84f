import {
  CheckIcon,
  Combobox,
  type ComboboxProps,
  Group,
  TextInput,
  type TextInputProps,
  useCombobox,
} from "@mantine/core";
import type { ReactNode } from "react";

interface Item {
  value: string;
  label: string;
}

interface Props extends Omit<TextInputProps, "value" | "onChange" | "size"> {
  data: readonly (Item | { group: string; items: readonly Item[] })[];
  value: string | null;
  onChange: (value: string) => void;
  /** a sentence in place of options where there is none */
  empty?: string;
  /** what an option shows before its label */
  mark?: (value: string) => ReactNode;
}

/** The list takes the width of its options, and the field's where that is more. */
const AS_WIDE_AS_FIELD: NonNullable<ComboboxProps["middlewares"]> = {
  size: {
    apply({ rects, elements }) {
      elements.floating.style.minWidth = `${rects.reference.width}px`;
    },
  },
};

/** One of a few, as the library's Select without search, clearing and scroll areas: the first page loads none of them. */
export function Choice({ data, value, onChange, empty = "There is nothing to choose.", mark, ...input }: Props) {
  const store = useCombobox({
    onDropdownOpen: () => store.updateSelectedOptionIndex("active"),
    onDropdownClose: () => store.resetSelectedOption(),
  });
  const option = (item: Item) => (
    <Combobox.Option
      key={item.value}
      value={item.value}
      active={item.value === value}
      aria-selected={item.value === value}
    >
      <Group gap={8} wrap="nowrap">
        {item.value === value && <CheckIcon size={10} />}
        {mark?.(item.value)}
        {item.label}
      </Group>
    </Combobox.Option>
  );
  const items = data.flatMap((entry) => ("items" in entry ? entry.items : [entry]));
  return (
    <Combobox
      __staticSelector="Select"
      store={store}
      size="xs"
      width="max-content"
      middlewares={AS_WIDE_AS_FIELD}
      position="bottom-start"
      onOptionSubmit={(chosen) => {
        onChange(chosen);
        store.closeDropdown();
      }}
    >
      <Combobox.Target targetType="button" withExpandedAttribute>
        <TextInput
          {...input}
          readOnly
          pointer
          value={items.find((item) => item.value === value)?.label ?? ""}
          rightSection={<Combobox.Chevron size="xs" />}
          rightSectionPointerEvents="none"
          onClick={() => store.toggleDropdown()}
          onBlur={() => store.closeDropdown()}
        />
      </Combobox.Target>
      <Combobox.Dropdown>
        <Combobox.Options mah={220} style={{ overflowY: "auto" }} aria-label={input["aria-label"]}>
          {items.length === 0 && <Combobox.Empty>{empty}</Combobox.Empty>}
          {data.map((entry) =>
            "items" in entry ? (
              <Combobox.Group key={entry.group} label={entry.group}>
                {entry.items.map(option)}
              </Combobox.Group>
            ) : (
              option(entry)
            ),
          )}
        </Combobox.Options>
      </Combobox.Dropdown>
    </Combobox>
  );
}
