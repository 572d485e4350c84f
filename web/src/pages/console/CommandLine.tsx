import { Button, TextInput } from "@mantine/core";
import { type KeyboardEvent, useEffect, useId, useRef, useState } from "react";
import type { RegisterRow } from "../../lib/rows/bits";
import css from "./console.module.css";
import { type Command, operandHint, parse, type Suggestion, suggest, usageOf } from "./grammar";

interface Props {
  commands: readonly Command[];
  rows: readonly RegisterRow[];
  /** sent before, newest first */
  lines: readonly string[];
  text: string;
  onText: (text: string) => void;
  connected: boolean;
  /** the commands and their operands are still on their way */
  loading: boolean;
  busy: boolean;
  onSend: (line: string) => void;
}

/** One line of TMCL: Tab takes the first proposal, arrows walk what was sent before, Enter sends. */
export function CommandLine({ commands, rows, lines, text, onText, connected, loading, busy, onSend }: Props) {
  const input = useRef<HTMLInputElement>(null);
  const back = useRef(-1);
  const typed = useRef("");
  /** what Tab was pressed on before there was anything to propose */
  const asked = useRef<string | null>(null);
  const hint = useId();
  const list = useId();
  const [focused, setFocused] = useState(false);
  const parsed = parse(text, commands);
  const offers = suggest(text, commands, rows);
  const open = focused && offers.length > 0;

  function take(offer: Suggestion) {
    onText(text.slice(0, parsed.from) + offer.insert);
    back.current = -1;
    input.current?.focus();
  }

  useEffect(() => {
    if (loading || asked.current === null) return;
    const first = asked.current === text ? offers[0] : undefined;
    asked.current = null;
    if (first) take(first);
  });

  function recall(by: number) {
    if (lines.length === 0) return;
    if (back.current === -1) typed.current = text;
    back.current = Math.max(-1, Math.min(lines.length - 1, back.current + by));
    onText(back.current === -1 ? typed.current : (lines[back.current] ?? ""));
  }

  function onKey(event: KeyboardEvent) {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const first = offers[0];
    if (event.key === "ArrowUp") recall(1);
    else if (event.key === "ArrowDown") recall(-1);
    else if (event.key === "Tab" && !event.shiftKey && first) take(first);
    else if (event.key === "Tab" && !event.shiftKey && loading && text !== "") asked.current = text;
    else return;
    event.preventDefault();
  }

  return (
    <form
      className="mb-4 relative"
      aria-busy={busy}
      onSubmit={(event) => {
        event.preventDefault();
        if (text.trim() === "" || !connected) return;
        back.current = -1;
        onSend(text.trim());
      }}
    >
      <div className="flex gap-6">
        <TextInput
          ref={input}
          size="sm"
          flex={1}
          aria-label="TMCL command"
          aria-describedby={hint}
          aria-controls={open ? list : undefined}
          placeholder="GAP 1, 0"
          classNames={{ input: "num" }}
          autoComplete="off"
          autoCapitalize="characters"
          spellCheck={false}
          value={text}
          onChange={(event) => {
            back.current = -1;
            onText(event.currentTarget.value);
          }}
          onKeyDown={onKey}
          onFocus={() => setFocused(true)}
          onBlur={() => setFocused(false)}
        />
        <Button size="sm" type="submit" disabled={!connected || text.trim() === ""}>
          Send
        </Button>
      </div>
      <div id={hint} className={`${css.hint} lines-8 hint baseline`}>
        <Hint text={text} parsed={parsed} connected={connected} />
      </div>
      {open && (
        <ul id={list} className={`${css.offers} card m-0`} aria-label="Proposals">
          {offers.map((offer, index) => (
            <li key={offer.insert + offer.detail}>
              <button
                type="button"
                tabIndex={-1}
                className={`${css.offer} plain lit flex baseline gap-8 pad-s text-12 w-full ${index === 0 ? "raised" : ""}`}
                // the line keeps the focus
                onMouseDown={(event) => event.preventDefault()}
                onClick={() => take(offer)}
              >
                <span className="num">{offer.label}</span>
                <span className="grow dim">{offer.detail}</span>
                {offer.moves && <Moves />}
                {index === 0 && <kbd className="tag mono">Tab</kbd>}
              </button>
            </li>
          ))}
        </ul>
      )}
    </form>
  );
}

export function Moves() {
  return <span className="tag caution nowrap">moves the motor</span>;
}

interface HintProps {
  text: string;
  parsed: ReturnType<typeof parse>;
  connected: boolean;
}

function Hint({ text, parsed, connected }: HintProps) {
  if (!connected) return <span>The module is not connected: commands can be written, not sent.</span>;
  const { command, operands, at } = parsed;
  if (text.trim() === "")
    return (
      <span>
        A mnemonic and its operands, with commas between them. <kbd className="tag mono">Tab</kbd> completes,{" "}
        <kbd className="tag mono">↑</kbd> brings back.
      </span>
    );
  if (command === null) return at === null ? <span>No such command yet.</span> : <span>No command has that name.</span>;
  const operand = at === null ? undefined : operands[at];
  return (
    <>
      <code className="ink text-12 mono">{usageOf(command)}</code>
      {command.moves && <Moves />}
      {!command.direct && <span className="caution">works only inside of a program</span>}
      <span>
        {operand === undefined ? command.help : `${operandHint(command, operand)}`}
        {operand === undefined && command.reply !== "" && ` Answers: ${command.reply}.`}
      </span>
    </>
  );
}
