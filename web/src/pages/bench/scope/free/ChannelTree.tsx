import { ActionIcon, Button, Checkbox, Select, Text, TextInput } from "@mantine/core";
import { IconMathFunction, IconX } from "@tabler/icons-react";
import { type DragEvent, useMemo, useState } from "react";
import type { Device } from "../../../../api/queries";
import type { ScopeSettings } from "../settings";
import { FormulaForm } from "./FormulaForm";
import classes from "./free.module.css";
import { added, Channels, DRAGGED, derivedPath, pathOf, without } from "./plan";

const NEW = "new";
/** More lines than this are found by typing. */
const LISTED_MAX = 60;

interface Props {
  devices: readonly Device[];
  settings: ScopeSettings;
  change: (part: Partial<ScopeSettings>) => void;
  onClose: () => void;
}

/** Every channel of every device: dragged into a plot, or ticked for the plot that is chosen. */
export function ChannelTree({ devices, settings, change, onClose }: Props) {
  const { free, derived } = settings;
  const [target, setTarget] = useState<string>(NEW);
  const [search, setSearch] = useState("");
  const [said, setSaid] = useState("");
  const [forming, setForming] = useState(false);
  const channels = useMemo(() => new Channels(devices, derived), [devices, derived]);
  const plot = free.find(({ id }) => id === target);
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  const found = (label: string) => words.every((word) => label.toLowerCase().includes(word));

  const toggle = (path: string) => {
    if (plot?.y.includes(path)) {
      change({ free: without(free, plot.id, path) });
      setSaid(`${channels.label(path)} taken out`);
      return;
    }
    const next = added(free, plot?.id ?? null, path, channels);
    if ("refused" in next) {
      setSaid(next.refused);
      return;
    }
    change(next);
    setSaid(`${channels.label(path)} is shown in plot ${plot ? free.indexOf(plot) + 1 : next.free.length}`);
    // what is ticked next goes beside it
    if (!plot) setTarget(next.free.at(-1)?.id ?? NEW);
  };

  const line = (path: string, label: string, unit: string) => (
    <li
      key={path}
      draggable
      className="row gap-6 text-12"
      style={{ cursor: "grab" }}
      data-path={path}
      onDragStart={(event: DragEvent) => {
        event.dataTransfer.setData(DRAGGED, path);
        event.dataTransfer.effectAllowed = "copy";
      }}
    >
      <Checkbox size="xs" label={label} checked={plot?.y.includes(path) ?? false} onChange={() => toggle(path)} />
      <span className="dim push">{unit}</span>
    </li>
  );

  return (
    <aside className={`${classes.tree} stack gap-6`} aria-label="Channels" data-testid="channel-tree">
      <div className="row between">
        <h3 className="m-0 text-12 bold">Channels</h3>
        <ActionIcon size={24} variant="subtle" aria-label="Close the channels" onClick={onClose}>
          <IconX size={14} />
        </ActionIcon>
      </div>
      <Select
        size="xs"
        label="Show in"
        allowDeselect={false}
        data={[
          { value: NEW, label: "a new plot" },
          ...free.map(({ id }, index) => ({ value: id, label: `plot ${index + 1}` })),
        ]}
        value={plot ? target : NEW}
        onChange={(value) => value && setTarget(value)}
      />
      <TextInput
        size="xs"
        aria-label="Find a channel"
        placeholder="Find: device, quantity, axis"
        value={search}
        onChange={(event) => setSearch(event.currentTarget.value)}
      />
      <Text size="xs" role="status">
        {said}
      </Text>
      <Button
        size="compact-xs"
        variant="default"
        leftSection={<IconMathFunction size={14} aria-hidden />}
        aria-expanded={forming}
        onClick={() => setForming(!forming)}
      >
        Derive by a formula
      </Button>
      {forming && (
        <FormulaForm
          channels={channels}
          derived={derived}
          onSave={(name, made) => {
            change({ derived: { ...derived, [name]: made } });
            setForming(false);
            setSaid(`${name} is among the channels`);
          }}
        />
      )}
      {Object.keys(derived).length > 0 && (
        <details open>
          <summary className="text-12 bold">Derived</summary>
          <ul className="list">
            {Object.keys(derived)
              .filter(found)
              .map((name) => line(derivedPath(name), name, channels.unit(derivedPath(name)) ?? "wrong now"))}
          </ul>
        </details>
      )}
      {devices.map((device) => {
        const shown = device.channels.filter(({ name }) => found(`${device.name} ${name}`));
        return (
          <details key={device.id} open={words.length > 0 || devices.length < 3}>
            <summary className="text-12 bold">{device.name}</summary>
            <ul className="list">
              {shown
                .slice(0, LISTED_MAX)
                .map(({ name }) => line(pathOf(device.id, name), name, channels.unit(pathOf(device.id, name)) ?? ""))}
            </ul>
            {shown.length > LISTED_MAX && (
              <Text size="xs">and {shown.length - LISTED_MAX} more: type to find them</Text>
            )}
          </details>
        );
      })}
    </aside>
  );
}
