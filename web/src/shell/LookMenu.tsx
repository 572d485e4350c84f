import { Menu, useMantineColorScheme } from "@mantine/core";
import { type Clock, type Density, look } from "../lib/look";
import { useShared } from "../lib/shared";

const SCHEMES = { auto: "as the system has them", light: "light", dark: "dark" };
const DENSITIES: Record<Density, string> = {
  auto: "by the pointer: dense, or for fingers",
  dense: "dense",
  normal: "normal",
  touch: "for fingers",
};
const CLOCKS: Record<Clock, string> = { local: "where this browser is", utc: "UTC" };

/** What the page looks like in this browser: colours, how dense it is, the zone of times. */
export function LookMenu({ close }: { close: () => void }) {
  const { colorScheme, setColorScheme } = useMantineColorScheme();
  const { density, clock } = useShared(look);
  return (
    <Menu opened onClose={close} position="bottom-end" closeOnItemClick={false}>
      <Menu.Target>
        <span />
      </Menu.Target>
      <Menu.Dropdown>
        <Choices title="Colours" all={SCHEMES} value={colorScheme} onChoose={setColorScheme} />
        <Choices
          title="Rows and controls"
          all={DENSITIES}
          value={density}
          onChoose={(next) => look.set({ ...look.get(), density: next })}
        />
        <Choices
          title="Times"
          all={CLOCKS}
          value={clock}
          onChoose={(next) => look.set({ ...look.get(), clock: next })}
        />
      </Menu.Dropdown>
    </Menu>
  );
}

interface ChoicesProps<Key extends string> {
  title: string;
  all: Record<Key, string>;
  value: Key;
  onChoose: (key: Key) => void;
}

function Choices<Key extends string>({ title, all, value, onChoose }: ChoicesProps<Key>) {
  return (
    <>
      <Menu.Label>{title}</Menu.Label>
      <Menu.RadioGroup value={value} onChange={(key) => onChoose(key as Key)}>
        {(Object.entries(all) as [Key, string][]).map(([key, text]) => (
          <Menu.RadioItem key={key} value={key}>
            {text}
          </Menu.RadioItem>
        ))}
      </Menu.RadioGroup>
    </>
  );
}
