import { Button, NativeSelect, Switch } from "@mantine/core";
import { fixed } from "../../../lib/format";
import { enumName, type RegisterRow, toSigned, unpackField, writable } from "../../../lib/rows/bits";
import { LiveText } from "../../../lib/rows/LiveText";
import common from "../../../lib/rows/rows.module.css";
import type { Edit } from "../../../lib/rows/staging";
import { timeOf } from "../../../lib/time";
import css from "./parameters.module.css";
import { nameText } from "./subjects";
import type { Asked } from "./useRead";

/** How a parameter is changed in its row: always at hand, or by an entry that opens. */
export function controlOf(row: RegisterRow): "switch" | "select" | "entry" | "none" {
  if (!writable(row.access)) return "none";
  if (row.fields.length > 0) return "none";
  const names = Object.values(row.values);
  if (row.minimum === 0 && row.maximum === 1 && (names.length === 0 || (names[0] === "off" && names[1] === "on")))
    return "switch";
  return names.length > 1 ? "select" : "entry";
}

export function numberOf(row: RegisterRow, raw: number | null | undefined): number | null {
  if (raw === null || raw === undefined) return null;
  return row.signed ? toSigned(raw, row.width) : raw;
}

interface Props {
  row: RegisterRow;
  /** as the module holds it; null where it is not known */
  value: number | null;
  raw: number | null;
  edit: Edit | null;
  unit: string;
  stage: (value: number) => void;
}

/** The value as it will be, in the control that suits it, or as text. */
export function ParameterValue({ row, value, raw, edit, unit, stage }: Props) {
  const shown = edit?.value ?? value;
  const label = nameText(row.name);
  if (row.fields.length > 0) return <Flags row={row} raw={raw} />;
  switch (controlOf(row)) {
    case "switch":
      return (
        <Switch
          data-control
          aria-label={label}
          label={shown === null ? "–" : shown === 1 ? "on" : "off"}
          classNames={{ label: css.switchText, root: common.live, trackLabel: css.trackLabel }}
          checked={shown === 1}
          disabled={shown === null}
          onChange={(event) => stage(event.currentTarget.checked ? 1 : 0)}
        />
      );
    case "select":
      return (
        <NativeSelect
          w={172}
          data-control
          aria-label={label}
          classNames={{ input: `${css.select} ${common.live}` }}
          data={optionsOf(row, shown)}
          value={shown === null ? "" : String(shown)}
          onChange={(event) => event.currentTarget.value !== "" && stage(Number(event.currentTarget.value))}
        />
      );
    default:
      return (
        <span className={common.value} data-wide>
          <span className="right">
            {value === null ? (
              <span className="dim">–</span>
            ) : (
              <LiveText className={`num ${common.live}`} text={enumName(row, value) ?? fixed(value)} />
            )}
          </span>
          <span className="hint ml-4">{unit}</span>
        </span>
      );
  }
}

function optionsOf(row: RegisterRow, shown: number | null) {
  const options = Object.entries(row.values)
    .filter(([value]) => Number(value) >= row.minimum && Number(value) <= row.maximum)
    .map(([value, name]) => ({ value, label: value === name ? name : `${value} · ${name}` }));
  if (shown === null) options.unshift({ value: "", label: "not known" });
  else if (enumName(row, shown) === undefined)
    options.push({ value: String(shown), label: `${shown} · without a name` });
  return options;
}

/** Flags by name, set ones standing out. */
function Flags({ row, raw }: { row: RegisterRow; raw: number | null }) {
  if (raw === null) return <span className="dim">–</span>;
  return (
    <span className={`inline wrap gap-4 breaks`}>
      {row.fields.map((field) => {
        const set = unpackField(raw, field) !== 0;
        return (
          <span key={field.name} className={`tag ${set ? "caution bold" : "tag-dashed dim"}`} title={field.help}>
            {field.name.replaceAll("_", " ")}
            <span className="unseen">{set ? " set" : " not set"}</span>
          </span>
        );
      })}
    </span>
  );
}

interface OnDemandProps {
  row: RegisterRow;
  asked: Asked | undefined;
  busy: boolean;
  connected: boolean;
  onRead: () => void;
}

/** A parameter that reading clears: nothing reads it but this button. */
export function OnDemand({ row, asked, busy, connected, onRead }: OnDemandProps) {
  return (
    <span className="inline wrap gap-8 text-12">
      <Button size="compact-xs" variant="default" loading={busy} disabled={!connected} onClick={onRead} data-control>
        Read and clear
      </Button>
      {asked ? (
        <>
          <Flags row={row} raw={asked.reading.raw} />
          <span className="dim">at {timeOf(asked.at)}</span>
        </>
      ) : (
        <span className="dim">reading it clears it, so it is read only when asked for</span>
      )}
    </span>
  );
}
