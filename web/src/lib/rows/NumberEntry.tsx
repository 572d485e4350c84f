import { ActionIcon, Group, Text, TextInput } from "@mantine/core";
import { IconCheck, IconX } from "@tabler/icons-react";
import { useId, useState } from "react";
import { fixed } from "../format";
import type { Bits } from "./bits";
import { parseInput, type Scale } from "./input";
import { chipUnit, physicalText } from "./physical";
import css from "./rows.module.css";

interface Props {
  bits: Bits;
  label: string;
  value: number | null;
  scales: readonly Scale[];
  onStage: (value: number) => void;
  /** given: the entry opened over a value, takes the focus, and has buttons to finish */
  onDone?: () => void;
}

/**
 * A number for the chip. What cannot be is refused while it is typed, with what can; nothing is staged before Enter,
 * the tick, or leaving a field that holds something valid. Escape cancels, and so does the cross.
 */
export function NumberEntry({ bits, label, value, scales, onStage, onDone }: Props) {
  const [draft, setDraft] = useState<string | null>(null);
  const hint = useId();
  const parsed = draft === null ? null : parseInput(draft, bits, scales);
  const wrong = parsed?.ok === false && draft?.trim() !== "" ? parsed.why : null;

  function finish() {
    if (parsed?.ok) onStage(parsed.value);
    if (parsed === null || parsed.ok) {
      setDraft(null);
      onDone?.();
    }
  }

  const unit = chipUnit(bits.unit);
  const preview = parsed?.ok ? physicalText(parsed.value, scales) : "";
  return (
    <Group
      gap={6}
      wrap="nowrap"
      className={`${css.entry} shrink relative`}
      data-inline={onDone !== undefined}
      data-escape-closes={onDone !== undefined || undefined}
    >
      <TextInput
        w={62 + bits.width * 2 + unit.length * 7}
        classNames={{ input: `num ${css.entryInput}` }}
        aria-label={label}
        aria-describedby={hint}
        error={wrong !== null}
        autoComplete="off"
        spellCheck={false}
        ref={onDone ? focusOnce : undefined}
        value={draft ?? (value === null ? "" : String(value))}
        rightSection={unit !== "" && <span className="hint ml-4">{unit}</span>}
        rightSectionWidth={14 + unit.length * 7}
        rightSectionPointerEvents="none"
        rightSectionProps={{ "aria-hidden": true }}
        onChange={(event) => setDraft(event.currentTarget.value)}
        onKeyDown={(event) => {
          if (event.key === "Escape") {
            setDraft(null);
            onDone?.();
          }
          if (event.key !== "Enter") return;
          event.preventDefault();
          event.stopPropagation();
          finish();
        }}
        onBlur={() => {
          // Over a value the entry stays until it is finished: a click elsewhere must not write by accident.
          if (!onDone && parsed?.ok) finish();
          else if (!onDone && draft?.trim() === "") setDraft(null);
        }}
      />
      {onDone && (
        <>
          <ActionIcon
            color="accent"
            size={26}
            variant="light"
            aria-label="Stage this value"
            disabled={!parsed?.ok}
            onClick={finish}
          >
            <IconCheck size={15} />
          </ActionIcon>
          <ActionIcon size={26} aria-label="Cancel the edit" onClick={onDone}>
            <IconX size={15} />
          </ActionIcon>
        </>
      )}
      {!onDone && wrong !== null && (
        <ActionIcon size={22} aria-label="Take it back" onClick={() => setDraft(null)}>
          <IconX size={13} />
        </ActionIcon>
      )}
      <Text
        id={hint}
        size="xs"
        component="span"
        className={wrong === null ? "shrink dim tight nowrap" : `shrink fault tight ${css.over}`}
        {...(wrong === null ? {} : { role: "alert" })}
      >
        {wrong ?? (preview || `${fixed(bits.minimum)} to ${fixed(bits.maximum)}`)}
      </Text>
    </Group>
  );
}

function focusOnce(input: HTMLInputElement | null): void {
  input?.focus();
  input?.select();
}
