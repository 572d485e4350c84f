import { Text, TextInput, type TextInputProps } from "@mantine/core";
import { useRef, useState } from "react";
import { flushSync } from "react-dom";
import { bound, decimalSum, exactText, parseNumber, rounded } from "./format";
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
  /** what it looks like while nobody is in it; who enters it finds every digit. By default 12 digits, or all of a whole number */
  show?: (value: number) => string;
  /** Enter, with the number that then stands there: what it begins must take this, not what was known before */
  onEnter?: (value: number) => void;
  /** given: the field may be left empty */
  onClear?: () => void;
  /** whether what stands there was refused: nothing may be begun with the value of before */
  onWrong?: (wrong: boolean) => void;
}

const DIGITS_AT_REST = 12;

function plain(value: number): string {
  return Number.isSafeInteger(value) ? String(value) : exactText(rounded(value, DIGITS_AT_REST));
}

/**
 * A number with its unit. It takes 1e3, 1.5k and 0x10, and says what is wrong with anything else instead of changing
 * it: a value out of range is never silently clamped, and never reported. What `show` rounds is for the eye alone: it
 * is neither edited nor reported.
 */
export function NumberField(props: NumberFieldProps) {
  const { value, onChange, unit = "", min, max, step = 1, integer = false, show = plain, error, ...rest } = props;
  const { onEnter, onClear, onWrong, ...input } = rest;
  const [draft, setDraft] = useState<string | null>(null);
  const [wrong, setWrong] = useState<string | null>(null);
  const [entered, setEntered] = useState(false);
  /** the last arrow key, while the answer to it is under way: the next one goes on from there */
  const nudged = useRef<{ from: number | null; to: number } | null>(null);
  /** a finger or mouse has come here: it says itself where to type */
  const pointed = useRef(false);
  const exact = value === null ? "" : exactText(value);

  function judge(text: string | null) {
    setWrong(text);
    if ((text === null) !== (wrong === null)) onWrong?.(text !== null);
  }

  function problem(candidate: number | null): string | null {
    if (candidate === null) return "Not a number";
    if (integer && !Number.isInteger(candidate)) return "A whole number is needed";
    if (Number.isInteger(candidate) && !Number.isSafeInteger(candidate)) return "Beyond 2^53 digits would be lost";
    if ((min !== undefined && candidate < min) || (max !== undefined && candidate > max)) {
      if (min === undefined) return `At most ${bound(max)}`;
      return max === undefined ? `At least ${bound(min)}` : `${bound(min)} to ${bound(max)}`;
    }
    return null;
  }

  /** What stands there, reported if it is new; null where it is none. */
  function commit(): number | null {
    if (draft === null) return value;
    if (onClear && draft.trim() === "") {
      setDraft(null);
      judge(null);
      onClear();
      return null;
    }
    const candidate = draft === exact && value !== null ? value : parseNumber(draft);
    const text = problem(candidate);
    judge(text);
    if (text !== null || candidate === null) return null;
    setDraft(null);
    nudged.current = null;
    if (candidate !== value) onChange(candidate);
    return candidate;
  }

  function nudge(by: number) {
    const { current: last } = nudged;
    const known = last !== null && last.from === value ? last.to : value;
    const next = decimalSum(parseNumber(draft ?? "") ?? known ?? 0, by);
    const to = Math.min(max ?? Number.POSITIVE_INFINITY, Math.max(min ?? Number.NEGATIVE_INFINITY, next));
    nudged.current = { from: value, to };
    setDraft(null);
    judge(null);
    onChange(to);
  }

  const symbol = symbolOf(unit);
  return (
    <TextInput
      inputMode={integer ? "numeric" : "decimal"}
      autoComplete="off"
      spellCheck={false}
      {...input}
      classNames={input.classNames ?? { input: "num" }}
      value={draft ?? (value === null ? "" : entered ? exact : show(value))}
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
        judge(null);
      }}
      onPointerDown={(event) => {
        pointed.current = true;
        input.onPointerDown?.(event);
      }}
      onFocus={(event) => {
        const { currentTarget: field } = event;
        // At once, and selected again: a change of the text loses the selection, and what is typed would go behind it.
        flushSync(() => setEntered(true));
        if (!pointed.current) field.select();
        input.onFocus?.(event);
      }}
      onBlur={(event) => {
        setEntered(false);
        pointed.current = false;
        commit();
        input.onBlur?.(event);
      }}
      onKeyDown={(event) => {
        input.onKeyDown?.(event);
        const unitStep = event.shiftKey ? step * 10 : step;
        if (event.key === "Enter") {
          const there = commit();
          if (there !== null) onEnter?.(there);
        } else if (event.key === "ArrowUp") nudge(unitStep);
        else if (event.key === "ArrowDown") nudge(-unitStep);
        else if (event.key === "PageUp") nudge(step * 10);
        else if (event.key === "PageDown") nudge(-step * 10);
        else return;
        if (event.key !== "Enter") event.preventDefault();
      }}
    />
  );
}
