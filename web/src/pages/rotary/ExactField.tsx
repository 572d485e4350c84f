import { Text, TextInput, type TextInputProps } from "@mantine/core";
import { useState } from "react";
import { parseRatio, type Ratio } from "./exact";

interface Props extends Omit<TextInputProps, "value" | "onChange" | "error"> {
  /** what it shows while nobody types */
  value: string;
  /** called with a number that `check` took: on Enter, and on leaving the field */
  onValue: (value: Ratio, text: string) => void;
  /** what is wrong with it, or null */
  check?: (value: Ratio) => string | null;
  unit?: string;
  /** Enter, after the value was taken */
  onEnter?: () => void;
  /** whether what stands there was refused: nothing may be begun with the value of before */
  onWrong?: (wrong: boolean) => void;
}

/** A number of any size, exactly as typed: 1e12, 2^40, 358400/3. `NumberField` ends at 2^53. */
export function ExactField({ value, onValue, check, unit = "", onEnter, onWrong, ...input }: Props) {
  const [draft, setDraft] = useState<string | null>(null);
  const [wrong, setWrong] = useState<string | null>(null);

  function judge(text: string | null) {
    setWrong(text);
    if ((text === null) !== (wrong === null)) onWrong?.(text !== null);
  }

  function commit(): boolean {
    if (draft === null || draft === value) {
      // what it showed already, which may be less than it holds
      setDraft(null);
      judge(null);
      return true;
    }
    const parsed = parseRatio(draft);
    const problem = parsed === null ? "Not a number" : (check?.(parsed) ?? null);
    judge(problem);
    if (parsed === null || problem !== null) return false;
    setDraft(null);
    onValue(parsed, draft.trim());
    return true;
  }

  return (
    <TextInput
      inputMode="text"
      autoComplete="off"
      spellCheck={false}
      {...input}
      classNames={{ input: "num" }}
      value={draft ?? value}
      error={wrong}
      onChange={(event) => {
        setDraft(event.currentTarget.value);
        judge(null);
      }}
      onBlur={commit}
      onKeyDown={(event) => {
        if (event.key === "Enter" && commit()) onEnter?.();
      }}
      rightSectionPointerEvents="none"
      {...(unit === ""
        ? {}
        : {
            rightSection: (
              <Text component="span" size="xs" c="dimmed" px={6} aria-hidden>
                {unit}
              </Text>
            ),
            rightSectionWidth: 18 + unit.length * 7.5,
          })}
    />
  );
}

/** For a `check`: whole, and between two numbers. */
export function whole(least: bigint, most: bigint, range: string): (value: Ratio) => string | null {
  return ({ n, d }) => {
    if (d !== 1n) return "A whole number is needed";
    return n < least || n > most ? range : null;
  };
}
