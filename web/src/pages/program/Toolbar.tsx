import { ActionIcon, Button, Group, NativeSelect, Tooltip } from "@mantine/core";
import {
  IconArrowBarRight,
  IconArrowBarToDown,
  IconArrowBarUp,
  IconPlayerPause,
  IconPlayerPlay,
  IconPlayerSkipBack,
  IconPlayerStop,
  type IconPlus,
  IconTextWrapDisabled,
} from "@tabler/icons-react";
import { memo } from "react";
import type { Command } from "./commands";
import { KEYS } from "./commands";

interface Props {
  labels: Readonly<Record<string, number>>;
  /** where a run begins: "" where it stands, else an address */
  from: string;
  onFrom: (from: string) => void;
  stepping: boolean;
  disabled: boolean;
  /** why a run cannot begin; empty where it can */
  cannotRun: string;
  onCommand: (command: Command) => void;
}

const BUTTONS: readonly [command: Command, label: string, icon: typeof IconPlus][] = [
  ["step", "Step into", IconArrowBarToDown],
  ["over", "Step over", IconArrowBarRight],
  ["out", "Step out", IconArrowBarUp],
  ["cursor", "Run to the cursor, by single steps", IconTextWrapDisabled],
  ["reset", "Reset: stop, counter and registers to 0", IconPlayerSkipBack],
];

/** What runs, steps and stops the program. */
export function Toolbar({ labels, from, onFrom, stepping, disabled, cannotRun, onCommand }: Props) {
  return (
    <Group gap={6} role="toolbar" aria-label="Run the program">
      <Tooltip label={cannotRun || `Run (${KEYS.run})`}>
        <Button
          leftSection={<IconPlayerPlay size={16} aria-hidden />}
          aria-keyshortcuts={KEYS.run}
          disabled={disabled || cannotRun !== ""}
          onClick={() => onCommand("run")}
        >
          Run
        </Button>
      </Tooltip>
      <Start labels={labels} from={from} onFrom={onFrom} />
      <Tooltip label={stepping ? `Pause (${KEYS.pause})` : `Stop the program (${KEYS.stop})`}>
        <Button
          variant="default"
          leftSection={stepping ? <IconPlayerPause size={16} aria-hidden /> : <IconPlayerStop size={16} aria-hidden />}
          aria-keyshortcuts={stepping ? KEYS.pause : KEYS.stop}
          disabled={disabled}
          onClick={() => onCommand(stepping ? "pause" : "stop")}
        >
          {stepping ? "Pause" : "Stop"}
        </Button>
      </Tooltip>
      {BUTTONS.map(([command, label, Icon]) => (
        <Tooltip key={command} label={`${label}${KEYS[command] ? ` (${KEYS[command]})` : ""}`}>
          <ActionIcon
            variant="default"
            size={30}
            aria-label={label}
            {...(KEYS[command] ? { "aria-keyshortcuts": KEYS[command] } : {})}
            disabled={disabled || stepping}
            onClick={() => onCommand(command)}
          >
            <Icon size={18} />
          </ActionIcon>
        </Tooltip>
      ))}
    </Group>
  );
}

/** Where the run begins. Not drawn anew for a key in the text: a program may have hundreds of labels. */
const Start = memo(function Start({ labels, from, onFrom }: Pick<Props, "labels" | "from" | "onFrom">) {
  const starts = [
    { value: "", label: "from where it is" },
    { value: "0", label: "from the start" },
    ...Object.entries(labels)
      .filter(([, address]) => address !== 0)
      .map(([label, address]) => ({ value: String(address), label: `from ${label} (${address})` })),
  ];
  return (
    <NativeSelect
      w={170}
      aria-label="Where the run begins"
      data={starts}
      value={from}
      onChange={({ currentTarget }) => onFrom(currentTarget.value)}
    />
  );
});
