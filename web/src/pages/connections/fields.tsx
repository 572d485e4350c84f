import { Autocomplete, Select, TextInput } from "@mantine/core";
import { type ReactNode, useState } from "react";
import css from "./connections.module.css";
import { emptyOf, type Field, type Group, helpOf } from "./form";
import { PortField } from "./PortField";

/** What a form holds of the fields of one object. */
export interface Entry {
  value: (field: Field) => string;
  /** the problem of a field, where it is to be told now */
  problem: (field: Field) => string | undefined;
  onChange: (field: Field, text: string) => void;
}

interface FieldProps extends Entry {
  field: Field;
  /** of a field in a table: whose it is; the heading is its label, and its problem stands below the table */
  of?: string;
  onFocus?: () => void;
}

/** A field of whatever kind that may be left empty: the placeholder shows what then holds. */
export function FieldInput({ field, of, value, problem, onChange, onFocus }: FieldProps) {
  const label = `${field.title}${of === undefined ? "" : ` of ${of}`}${field.unit ? ` [${field.unit}]` : ""}`;
  const wrong = problem(field);
  const change = (text: string | null) => onChange(field, text ?? "");
  const common = {
    ...(of === undefined ? { label } : { "aria-label": label }),
    "aria-description": helpOf(field),
    placeholder: emptyOf(field),
    value: value(field),
    error: of === undefined ? wrong : wrong !== undefined,
    ...(onFocus ? { onFocus } : {}),
  } as const;
  const WIDE = { gridColumn: "1 / -1" };
  if (field.options)
    return (
      <Select
        {...common}
        classNames={{ label: "hint regular" }}
        {...(of === undefined ? { style: WIDE } : {})}
        data={field.options}
        value={common.value || String(field.default ?? "")}
        onChange={change}
      />
    );
  if (field.ports) return <PortField {...common} style={WIDE} onChange={change} />;
  const typed = {
    ...common,
    classNames: { input: field.path === "name" ? "" : "num", label: "hint regular" },
    inputMode: field.type === "integer" ? "numeric" : field.type === "number" ? "decimal" : "text",
    autoComplete: "off",
    spellCheck: false,
  } as const;
  const values = field.examples?.map(String) ?? [];
  return values.length > 1 ? (
    <Autocomplete {...typed} data={values} filter={({ options }) => options} onChange={change} />
  ) : (
    <TextInput {...typed} onChange={(event) => change(event.currentTarget.value)} />
  );
}

/** What the field is for that one is in, or was last. It stands below the fields, and stays when one leaves them: nothing
 *  moves under a press. */
function useHelp(entries: readonly Entry[]): [told: ReactNode, tell: (field: Field) => () => void] {
  const [field, tell] = useState<Field>();
  // a problem says by itself what is allowed
  const wrong = field !== undefined && entries.some(({ problem }) => problem(field) !== undefined);
  const text = field && [field.title, wrong ? field.help : helpOf(field)].filter(Boolean).join(": ");
  return [text && <div className="hint mt-4">{text}</div>, (next) => () => tell(next)];
}

function Heading({ group: { title, help } }: { group: Group }) {
  return <div className="hint mb-4">{[title, help].filter(Boolean).join(" · ")}</div>;
}

/** Fields of one object, side by side. */
export function FieldGroup({ group, ...entry }: Entry & { group: Group }) {
  const [told, tell] = useHelp([entry]);
  return (
    <div>
      <Heading group={group} />
      <div className={`${css.two} halves start gap-8`}>
        {group.fields.map((field) => (
          <FieldInput key={field.path} field={field} {...entry} onFocus={tell(field)} />
        ))}
      </div>
      {told}
    </div>
  );
}

export interface Row extends Entry {
  /** among the others */
  id: string;
  name: string;
}

/** The same fields of every axis: a line an axis, a column a field. */
export function AxisTable({ group, rows }: { group: Group; rows: readonly Row[] }) {
  const [told, tell] = useHelp(rows);
  const { fields } = group;
  // a name that cannot be changed here stands before its line
  const named = fields[0]?.path === "name";
  const problems = rows.flatMap((row) =>
    fields.flatMap((field) => {
      const problem = row.problem(field);
      return problem === undefined ? [] : [`${row.name}, ${field.title}: ${problem}`];
    }),
  );
  const gridTemplateColumns = `${named ? "" : "40px "}repeat(${fields.length}, minmax(0, 1fr))`;
  return (
    <div>
      <Heading group={group} />
      <div className={css.axisGrid} style={{ gridTemplateColumns }}>
        {!named && <span>Axis</span>}
        {fields.map(({ path, heading, title }) => (
          <span key={path}>{heading ?? title}</span>
        ))}
        {rows.map((row) => (
          <div key={row.id} className="contents">
            {!named && <span className={css.stageName}>{row.name}</span>}
            {fields.map((field) => (
              <FieldInput key={field.path} field={field} of={row.id} {...row} onFocus={tell(field)} />
            ))}
          </div>
        ))}
      </div>
      {told}
      {problems.length > 0 && (
        <div className="m-0 mt-4 fault text-12" role="alert">
          {problems.map((line) => (
            <div key={line}>{line}</div>
          ))}
        </div>
      )}
    </div>
  );
}

interface FoldProps {
  group: Group;
  rows: readonly Row[];
  /** below the fields of an axis */
  note?: (index: number) => ReactNode;
}

/** More fields of every axis, folded away until one of them says something. */
export function AxisFold({ group, rows, note }: FoldProps) {
  const [told, tell] = useHelp(rows);
  const [open, setOpen] = useState(rows.some((row) => group.fields.some((field) => row.value(field) !== "")));
  const wrong = rows.some((row) => group.fields.some((field) => row.problem(field) !== undefined));
  return (
    <details
      className={`${css.limits} pad-s box mt-8`}
      open={open || wrong}
      onToggle={(event) => setOpen(event.currentTarget.open)}
    >
      <summary>
        {group.title}
        <span className={`${css.limitNote} hint regular`}>{group.help}</span>
      </summary>
      {rows.map((row, index) => (
        <fieldset key={row.id} className={css.limitAxis}>
          <legend>{row.name}</legend>
          <div className={css.limitGrid}>
            {group.fields.map((field) => (
              <FieldInput key={field.path} field={field} {...row} onFocus={tell(field)} />
            ))}
          </div>
          {note?.(index)}
        </fieldset>
      ))}
      {told}
    </details>
  );
}
