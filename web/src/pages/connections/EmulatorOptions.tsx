import { IconChevronRight } from "@tabler/icons-react";
import css from "./connections.module.css";
import { OptionalNumber } from "./fields";
import type { Model } from "./models";
import { optionsOf } from "./options";

interface Props {
  model: Model;
  options: Readonly<Record<string, string>>;
  /** the problem of a field, where it is to be told now */
  problem: (path: string, text: string) => string | undefined;
  onChange: (options: Record<string, string>) => void;
  open: boolean;
  onOpen: (open: boolean) => void;
}

/** An emulated motor and what is around it, folded away: its defaults are good. */
export function EmulatorOptions({ model, options, problem, onChange, open, onOpen }: Props) {
  const groups = optionsOf(model);
  return (
    <>
      <button
        type="button"
        className={`${css.more} row gap-4 p-0 accent`}
        aria-expanded={open}
        onClick={() => onOpen(!open)}
      >
        <IconChevronRight size={13} className={css.chevron} data-open={open} aria-hidden />
        Emulator: motor, load, stage{groups.some(([title]) => title.startsWith("Encoder")) && ", encoder"}
      </button>
      {open &&
        groups.map(([title, rows]) => (
          <div key={title}>
            <div className="hint mb-4">{title}</div>
            <div className={`${css.two} halves start gap-8`}>
              {rows.map((row) => (
                <OptionalNumber
                  key={row.key}
                  label={row.label}
                  {...(row.unit === "" ? {} : { unit: row.unit })}
                  value={options[row.key] ?? ""}
                  limits={row.limits}
                  problem={problem(`options.${row.key}`, options[row.key] ?? "")}
                  onChange={(text) => onChange({ ...options, [row.key]: text })}
                />
              ))}
            </div>
          </div>
        ))}
    </>
  );
}
