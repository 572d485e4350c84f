import { IconLock } from "@tabler/icons-react";
import { Fragment } from "react";
import { fixed, hex, withUnit } from "../format";
import { accessText, enumName, type FieldRow, type RegisterRow, summary, toSigned } from "./bits";
import type { Scale } from "./input";
import { LiveText } from "./LiveText";
import { chipUnit, pairText } from "./physical";
import css from "./rows.module.css";
import { changes, type Edit } from "./staging";
import type { Reading } from "./useRegisters";

/** A register's name, which may wrap after an underscore only. */
export function RegisterName({ name, strong = false }: { name: string; strong?: boolean }) {
  const words = name.split("_");
  return (
    <span className={`text-12 mono tight ${strong ? "bold" : ""}`}>
      {words.map((word, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: the words of one name never change places
        <Fragment key={index}>
          {word}
          {index < words.length - 1 && (
            <>
              _<wbr />
            </>
          )}
        </Fragment>
      ))}
    </span>
  );
}

export function AccessMark({ access }: { access: string }) {
  return (
    <span
      className={`tag inline gap-2 mono nowrap ${access === "R" ? "tag-dashed dim" : access === "W" ? "bold" : ""}`}
      title={accessText(access)}
    >
      {access === "R" && <IconLock size={10} aria-hidden />}
      {access}
    </span>
  );
}

/** What else has to be known beside a register's name: when it is one, and that the emulator only stores it. */
export function NameTags({ row }: { row: Pick<RegisterRow, "when" | "behaviour"> }) {
  return (
    <>
      {row.when && <span className={`${css.tag} tag tag-dashed dim inline-block ml-4 regular`}>if {row.when}</span>}
      {row.behaviour && (
        <span
          className={`${css.tag} tag tag-dashed dim inline-block ml-4 regular`}
          title={`The emulator keeps it without acting on it: ${row.behaviour}`}
        >
          stored only
        </span>
      )}
    </>
  );
}

/** The raw word, or why there is none. One that cannot be read looks so: it is what was written. */
export function RawText({ row, reading }: { row: RegisterRow; reading: Reading | undefined }) {
  if (row.access === "W" && !reading) return <span className={`${css.noRaw} hint`}>write only</span>;
  if (row.read_clears)
    return (
      <span className={`${css.noRaw} hint`} title="Reading clears it, so it is not polled">
        not polled
      </span>
    );
  if (!reading) return <span className="dim">–</span>;
  const text = hex(reading.raw, row.width);
  return reading.kept ? (
    <span className={`num ${css.kept}`} title="As last written, or as after the reset: it cannot be read">
      {text}
    </span>
  ) : (
    <LiveText className={`num ${css.live}`} text={text} />
  );
}

/** The value in chip units. Its digits end, and its unit begins, at the same place in every row. */
export function ValueText({ row, raw }: { row: RegisterRow; raw: number | null }) {
  const value = raw === null ? null : row.signed ? toSigned(raw, row.width) : raw;
  return (
    <span className={css.value}>
      <span className="right">
        {value === null ? (
          <span className="dim">–</span>
        ) : (
          <LiveText className={`num ${css.live}`} text={enumName(row, value) ?? fixed(value)} />
        )}
      </span>
      <span className="hint ml-4">{chipUnit(row.unit)}</span>
    </span>
  );
}

/** A value in each physical unit that the axis knows; of a staged one, what it will be. */
export function PhysicalText({ row, raw, edit, scales, also }: PhysicalProps) {
  const staged = edit?.value ?? null;
  const value = staged ?? (raw === null ? null : row.signed ? toSigned(raw, row.width) : raw);
  const parts =
    value === null
      ? []
      : [...scales.map((scale) => withUnit(value * scale.perChip, scale.unit, 3)), ...(also?.(value) ?? [])];
  return (
    <span className={`${css.physicals} hint flex`} title={parts.length > 1 ? parts.join(" · ") : undefined}>
      {staged !== null && (
        <span className="num rigid accent bold">
          <span className="mx-4 accent">→</span>
          {enumName(row, staged) ?? fixed(staged)}
        </span>
      )}
      {parts.map((part) => (
        <span key={part} className={css.physicalPart}>
          {part}
        </span>
      ))}
    </span>
  );
}

interface PhysicalProps {
  row: RegisterRow;
  raw: number | null;
  edit: Edit | null;
  scales: readonly Scale[];
  /** what else a value stands for */
  also?: (value: number) => string[];
}

/** A packed register's fields in one line, staged ones first. */
export function PackedText({ row, raw, edit }: { row: RegisterRow; raw: number | null; edit: Edit | null }) {
  const staged = edit ? changes(edit, row, raw) : [];
  const all = raw === null ? "" : [summary(row, raw), pairText(row, raw)].filter(Boolean).join(" · ");
  return (
    <span className={`${css.packed} flex shrink gap-8`} title={all}>
      {staged.map((change) => (
        <span key={change.field?.name} className="rigid accent text-12 nowrap">
          {change.field?.access === "R+WC" ? (
            <b>clear {change.field.name}</b>
          ) : (
            <>
              {change.field?.name} {change.from === null ? "?" : nameOf(change.field, change.from)}
              <span className="mx-4 accent">→</span>
              <b>{nameOf(change.field, change.to)}</b>
            </>
          )}
        </span>
      ))}
      {raw === null ? (
        <span className="dim">–</span>
      ) : (
        <LiveText className={`${css.live} ${css.summary} clip shrink text-12`} text={all} />
      )}
    </span>
  );
}

function nameOf(field: FieldRow | null, value: number): string {
  return (field ? enumName(field, value) : undefined) ?? fixed(value);
}

/** A text of the catalog as a sentence. */
export function sentence(text: string): string {
  return text === "" ? "" : `${text.charAt(0).toUpperCase()}${text.slice(1)}.`;
}

/** A data sheet's key (docs/sources.md) as it is called, and what the maker has published as code. */
export function sourceText(source: string): string {
  return source
    .replace(/\bDS-(\w+)/g, "$1 data sheet")
    .replace(/\bFM-\S+/g, "TMCL manual")
    .replace(/\bAPI\b/g, "the maker’s TMC-API")
    .replace(/\bPY\b/g, "PyTrinamic");
}
