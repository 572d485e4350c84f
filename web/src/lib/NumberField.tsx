import { Text, TextInput, type TextInputProps } from "@mantine/core";
import { useState } from "react";
import { compact, parseNumber } from "./format";
import { symbolOf } from "./units";

export interface NumberFieldProps extends Omit<TextInputProps, "value" | "onChange" | "min" | "max" | "step"> {
  value: number | null;
  /** called with a number within min..max, when the person is done: Enter, leaving the field, an arrow key */
  onChange: (value: number) => void;
  unit?: string;
  min?: number;
  max?: number;
  /** what an arrow key adds; ten times that with Shift. Also Page up and down */
  step?: number;
  integer?: boolean;
  /** decimals that the field shows at rest; by default as many as the number needs, up to 6 digits */
  show?: (value: number) => string;
}

function plain(value: number): string {
  // all digits of a whole number count: 16777215 is not 16777220
  return Number.isSafeInteger(value) ? String(value) : String(Number(value.toPrecision(7)));
}

/**
 * A number with its unit. It takes 1e3, 1.5k and 0x10, and says what is wrong with anything else instead of changing
 * it: a value out of range is never silently clamped, and never reported.
 */
export function NumberField(props: NumberFieldProps) {
  const { value, onChange, unit = "", min, max, step = 1, integer = false, show = plain, error, ...input } = props;
  const [draft, setDraft] = useState<string | null>(null);
  const [wrong, setWrong] = useState<string | null>(null);

  function problem(candidate: number | null): string | null {
    if (candidate === null) return "Not a number";
    if (integer && !Number.isInteger(candidate)) return "A whole number is needed";
    if ((min !== undefined && candidate < min) || (max !== undefined && candidate > max)) {
      if (min === undefined) return `At most ${compact(max)}`;
      return max === undefined ? `At least ${compact(min)}` : `${compact(min)} to ${compact(max)}`;
    }
    return null;
  }

  function commit() {
    if (draft === null) return;
    const candidate = parseNumber(draft);
    const text = problem(candidate);
    setWrong(text);
    if (text !== null || candidate === null) return;
    setDraft(null);
    if (candidate !== value) onChange(candidate);
  }

  function nudge(by: number) {
    const base = parseNumber(draft ?? "") ?? value ?? 0;
    const next = Math.min(max ?? Number.POSITIVE_INFINITY, Math.max(min ?? Number.NEGATIVE_INFINITY, base + by));
    setDraft(null);
    setWrong(null);
    // sums of decimal steps would show binary dust: 0.30000000000000004
    onChange(Number(next.toPrecision(12)));
  }

  const symbol = symbolOf(unit);
  return (
    <TextInput
      size="xs"
      inputMode={integer ? "numeric" : "decimal"}
      autoComplete="off"
      spellCheck={false}
      {...input}
      classNames={input.classNames ?? { input: "num" }}
      value={draft ?? (value === null ? "" : show(value))}
      error={wrong ?? error}
      rightSectionPointerEvents="none"
      {...(symbol === ""
        ? {}
        : {
            rightSection: (
              <Text component="span" size="xs" c="dimmed" px={6} aria-hidden>
                {symbol}
              </Text>
            ),
            rightSectionWidth: 18 + symbol.length * 7.5,
          })}
      aria-label={
        input["aria-label"] ?? (typeof input.label === "string" ? `${input.label} ${symbol}`.trim() : undefined)
      }
      onChange={(event) => {
        setDraft(event.currentTarget.value);
        setWrong(null);
      }}
      onBlur={commit}
      onKeyDown={(event) => {
        input.onKeyDown?.(event);
        const unitStep = event.shiftKey ? step * 10 : step;
        if (event.key === "Enter") commit();
        else if (event.key === "ArrowUp") nudge(unitStep);
        else if (event.key === "ArrowDown") nudge(-unitStep);
        else if (event.key === "PageUp") nudge(step * 10);
        else if (event.key === "PageDown") nudge(-step * 10);
        else return;
        if (event.key !== "Enter") event.preventDefault();
      }}
    />
  );
}
