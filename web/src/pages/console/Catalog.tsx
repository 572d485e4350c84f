import { useState } from "react";
import { Moves } from "./CommandLine";
import css from "./console.module.css";
import { type Command, commandName, operandsOf, usageOf } from "./grammar";

interface Props {
  commands: readonly Command[];
  onTake: (line: string) => void;
}

/** Every command with how it is written and what it does; a click begins a line with it. */
export function Catalog({ commands, onTake }: Props) {
  const [open, setOpen] = useState(false);
  return (
    <div>
      <button
        type="button"
        className="plain underlined accent text-12"
        aria-expanded={open}
        onClick={() => setOpen(!open)}
      >
        {open ? "Hide the commands" : `All ${commands.length} commands`}
      </button>
      {open && (
        <ul className="tall list box mt-4 scroll">
          {commands.map((command) => (
            <li key={command.opcode} className="rule-top">
              <button
                type="button"
                className={`${css.catalogEntry} plain lit columns pad-s text-12 w-full`}
                data-direct={command.direct}
                disabled={!command.direct}
                onClick={() => onTake(commandName(command) + (operandsOf(command).length > 0 ? " " : ""))}
              >
                <code className="ink text-12 mono">{usageOf(command)}</code>
                <span className="lines-8 dim">
                  {command.help || command.name}
                  {command.moves && <Moves />}
                  {!command.direct && <span className="m-0 dim"> only inside of a program</span>}
                </span>
              </button>
            </li>
          ))}
        </ul>
      )}
    </div>
  );
}
