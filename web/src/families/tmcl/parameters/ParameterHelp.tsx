import { Text } from "@mantine/core";
import { fixed } from "../../../lib/format";
import { enumName, type RegisterRow, toSigned } from "../../../lib/rows/bits";
import { sentence, sourceText } from "../../../lib/rows/parts";
import common from "../../../lib/rows/rows.module.css";
import { type Context, meaningOf, rangeOf, unitText } from "./quantities";
import { nameText, placeText, subjectTitle } from "./subjects";

interface Props {
  row: RegisterRow;
  context: Context;
  /** the module's firmware does not have it */
  lacking?: boolean;
  heading?: boolean;
}

/** Everything that is known about one parameter. */
export function ParameterHelp({ row, context, lacking = false, heading = false }: Props) {
  const range = rangeOf(row, context.mode);
  const unit = unitText(row, context.mode);
  const named = Object.entries(row.values);
  const reset = row.reset === null ? null : row.signed ? toSigned(row.reset, row.width) : row.reset;
  const meaning = (value: number) => {
    const text = meaningOf(row, value, context);
    return text === "" ? "" : ` = ${text}`;
  };
  return (
    <div>
      {heading && <h2 className="m-0 mb-8 text-14">{nameText(row.name)}</h2>}
      <Text size="sm" mb={6}>
        {sentence(row.help)}
      </Text>
      {lacking && (
        <Text size="sm" mb={6} className="dim">
          The module answers that it has no such parameter: other firmware has it, or another variant of the module.
        </Text>
      )}
      <dl className={`${common.facts} facts grid m-0 text-12`}>
        <dt>Number</dt>
        <dd>
          <span className="num">{row.alias}</span>, {placeText(row)}, {subjectTitle(row.group)}
        </dd>
        <dt>Name</dt>
        <dd className="text-12 mono anywhere">{row.name}</dd>
        <dt>Access</dt>
        <dd>
          {row.access === "R" ? "read only" : row.access === "W" ? "write only" : "read and write"}
          {row.read_clears && "; reading clears it"}
          {row.volatile && "; the module changes it by itself"}
        </dd>
        {row.write_note !== "" && (
          <>
            <dt>Writing</dt>
            <dd>{sentence(row.write_note)}</dd>
          </>
        )}
        {row.fields.length === 0 && named.length === 0 && (
          <>
            <dt>Range</dt>
            <dd className="anywhere">
              <span className="num">
                {fixed(range.minimum)} to {fixed(range.maximum)}
              </span>{" "}
              {unit}
              {meaning(range.maximum) !== "" && (
                <div className="dim">
                  at most <span className="hint breaks">{meaningOf(row, range.maximum, context)}</span>
                </div>
              )}
            </dd>
          </>
        )}
        {named.length > 0 && (
          <>
            <dt>Values</dt>
            <dd>
              {named.map(([value, name]) => (
                <div key={value}>
                  <span className="num">{value}</span> {name}
                </div>
              ))}
            </dd>
          </>
        )}
        {row.fields.map((field) => (
          <FieldText key={field.name} name={field.name} bit={field.lsb} help={field.help} />
        ))}
        <dt>At delivery</dt>
        <dd>
          {reset === null ? "no source tells" : <span className="num">{enumName(row, reset) ?? fixed(reset)}</span>}
          {reset !== null && meaning(reset)}
        </dd>
        <dt>Memory</dt>
        <dd>{MEMORY[row.stored]}</dd>
        <dt>Source</dt>
        <dd>{sourceText(row.source)}</dd>
      </dl>
    </div>
  );
}

const MEMORY: Record<RegisterRow["stored"], string> = {
  "": "RAM alone: gone with the power",
  auto: "RAM, and EEPROM with every write",
  "on request": "RAM; EEPROM when told to store it",
  unknown: "not known",
};

function FieldText({ name, bit, help }: { name: string; bit: number; help: string }) {
  return (
    <>
      <dt className="num">bit {bit}</dt>
      <dd>
        <b>{name.replaceAll("_", " ")}</b> {help}
      </dd>
    </>
  );
}
