import { Button, Group, Text } from "@mantine/core";
import { can } from "../../api/queries";
import { fixed, hex } from "../../lib/format";
import type { RowActions } from "../../lib/rows/actions";
import { accessText, enumName, type RegisterRow, toSigned, unpackField, writable } from "../../lib/rows/bits";
import { rangeText } from "../../lib/rows/input";
import { AccessMark, RegisterName, sentence, sourceText } from "../../lib/rows/parts";
import common from "../../lib/rows/rows.module.css";
import { keyOf } from "../../lib/rows/staging";
import { useSelection } from "../../live/selection";
import { ReadOnce } from "./ReadOnce";

interface Props {
  row: RegisterRow;
  raw: number | null;
  /** what else stands at its address: "X_RANGE when written" */
  beside: string;
  actions: RowActions;
  heading?: boolean;
}

/** Everything that is known about one register, and the way back to its default. */
export function RegisterHelp({ row, raw, beside, actions, heading = false }: Props) {
  const { device } = useSelection();
  const anyWrite = /\bany write\b/i.test(`${row.help} ${row.write_note}`);
  const canReset = writable(row.access) && row.reset !== null && !anyWrite;
  return (
    <div>
      {heading && (
        <h2 className="m-0 mb-8 text-14">
          <RegisterName name={row.name} strong />
        </h2>
      )}
      <Text size="sm" mb={6}>
        {sentence(row.help)}
      </Text>
      <dl className={`${common.facts} facts grid m-0 text-12`}>
        <dt>Address</dt>
        <dd>
          <span className="num">{hex(row.address, 8)}</span>, {row.axis === null ? "whole chip" : `axis ${row.axis}`},{" "}
          {row.group}
        </dd>
        {row.when && (
          <>
            <dt>Holds if</dt>
            <dd>{row.when}. Otherwise the word has its plain name.</dd>
          </>
        )}
        {beside !== "" && (
          <>
            <dt>Shares it</dt>
            <dd>{beside}</dd>
          </>
        )}
        <dt>Access</dt>
        <dd>
          <AccessMark access={row.access} /> {accessText(row.access)}
        </dd>
        {row.write_note !== "" && (
          <>
            <dt>Writing</dt>
            <dd>{sentence(row.write_note)}</dd>
          </>
        )}
        {row.read_clears && (
          <>
            <dt>Reading</dt>
            <dd>
              {row.untold.includes("clearing")
                ? "Reading may clear it: no source tells. So this page does not poll it."
                : "Reading clears it, so this page does not poll it."}
              {can(device, "events") && " What it tells is below the scope of the bench, where nothing is lost."}
              <ReadOnce key={keyOf(row)} device={device} row={row} />
            </dd>
          </>
        )}
        {row.behaviour && (
          <>
            <dt>Emulator</dt>
            <dd>It keeps the word without acting on it: {row.behaviour}.</dd>
          </>
        )}
        {row.volatile && (
          <>
            <dt>Changes</dt>
            <dd>The chip changes it by itself; a read-back may differ from what was written.</dd>
          </>
        )}
        <dt>Width</dt>
        <dd>
          {row.untold.includes("width") ? (
            <>
              no source tells: <span className="num">{row.width}</span> bits travel
            </>
          ) : (
            <>
              <span className="num">{row.width}</span> bits{row.signed ? ", two's complement" : ""}
            </>
          )}
        </dd>
        {row.fields.length === 0 && (
          <>
            <dt>Range</dt>
            <dd className="num">{rangeText({ minimum: row.minimum, maximum: row.maximum })}</dd>
          </>
        )}
        {row.unit !== "" && (
          <>
            <dt>Unit</dt>
            <dd className="text-12 mono anywhere">{row.unit}</dd>
          </>
        )}
        <dt>Reset</dt>
        <dd>{row.reset === null ? "no source tells" : resetText(row, row.reset)}</dd>
        <dt>Source</dt>
        <dd>{sourceText(row.source)}</dd>
      </dl>
      <Group gap="xs" mt="sm">
        {canReset && (
          <Button size="compact-xs" variant="default" onClick={() => stageReset(row, raw, actions)}>
            Stage the reset value
          </Button>
        )}
        {anyWrite && writable(row.access) && (
          <Button size="compact-xs" variant="default" onClick={() => actions.stage(row, null, 0, raw)}>
            Stage a write
          </Button>
        )}
      </Group>
    </div>
  );
}

function resetText(row: RegisterRow, reset: number) {
  const value = row.signed ? toSigned(reset, row.width) : reset;
  const name = enumName(row, value);
  return (
    <span className="num">
      {hex(reset, row.width)}
      {row.fields.length === 0 && ` = ${name ?? fixed(value)}`}
    </span>
  );
}

function stageReset(row: RegisterRow, raw: number | null, actions: RowActions): void {
  const reset = row.reset ?? 0;
  if (row.fields.length === 0) {
    actions.stage(row, null, row.signed ? toSigned(reset, row.width) : reset, raw);
    return;
  }
  for (const field of row.fields) {
    // Flags that are cleared by writing 1 have no value to go back to.
    if (field.access === "RW" || field.access === "RW*") actions.stage(row, field, unpackField(reset, field), raw);
  }
}
