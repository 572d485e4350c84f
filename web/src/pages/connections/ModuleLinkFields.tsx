import { Autocomplete, TextInput } from "@mantine/core";
import { fixed } from "../../lib/format";
import css from "./connections.module.css";
import { OptionalNumber } from "./fields";
import { BAUDS, CAN_BITRATES, CAN_INTERFACES, MODULE_LIMITS, type ModuleDraft, type ModuleKind } from "./module";
import { PortField } from "./PortField";

interface Props {
  kind: Exclude<ModuleKind, "emulator">;
  draft: ModuleDraft;
  /** the problem of a field, where it is to be told now */
  problem: (path: string, text: string) => string | undefined;
  onChange: (change: Partial<ModuleDraft>) => void;
}

type NumberPart = keyof typeof MODULE_LIMITS;

/** The way to a module: on a serial line, behind a socket, or on CAN. */
export function ModuleLinkFields({ kind, draft, problem, onChange }: Props) {
  const numeric = (part: NumberPart, label: string, unit?: string, placeholder?: string) => (
    <OptionalNumber
      label={label}
      {...(unit === undefined ? {} : { unit })}
      {...(placeholder === undefined ? {} : { placeholder })}
      value={draft[part]}
      limits={MODULE_LIMITS[part]}
      problem={problem(`module.${part}`, draft[part])}
      onChange={(text) => onChange({ [part]: text })}
    />
  );
  const typed = (part: "baud" | "bitrate", label: string, rates: readonly number[]) => (
    <Autocomplete
      size="xs"
      label={label}
      placeholder={fixed(MODULE_LIMITS[part].fallback)}
      classNames={{ input: "num", label: "hint regular" }}
      data={rates.map(String)}
      filter={({ options }) => options}
      value={draft[part]}
      error={problem(`module.${part}`, draft[part])}
      inputMode="numeric"
      onChange={(text) => onChange({ [part]: text })}
    />
  );

  if (kind === "serial")
    return (
      <>
        <PortField
          label="Port or address"
          value={draft.serialPort}
          problem={problem("module.serialPort", draft.serialPort)}
          onChange={(serialPort) => onChange({ serialPort })}
        />
        <div className={`${css.three} grid start gap-8`}>
          {typed("baud", "Baud (not on USB)", BAUDS)}
          {numeric("address", "Module address")}
          {numeric("timeoutS", "Answer within", "s")}
        </div>
      </>
    );
  if (kind === "tcp")
    return (
      <>
        <div className={`${css.tcpModule} grid start gap-8`}>
          <TextInput
            size="xs"
            label="Host"
            placeholder="127.0.0.1"
            classNames={{ input: "num", label: "hint regular" }}
            value={draft.host}
            error={problem("module.host", draft.host)}
            autoComplete="off"
            spellCheck={false}
            onChange={(event) => onChange({ host: event.currentTarget.value })}
          />
          {numeric("tcpPort", "Port", undefined, "4242")}
        </div>
        <div className={`${css.two} halves start gap-8`}>
          {numeric("address", "Module address")}
          {numeric("timeoutS", "Answer within", "s", "1")}
        </div>
      </>
    );
  return (
    <>
      <div className={`${css.two} halves start gap-8`}>
        <Autocomplete
          size="xs"
          label="Interface of python-can"
          classNames={{ input: "num", label: "hint regular" }}
          data={CAN_INTERFACES}
          filter={({ options }) => options}
          value={draft.canInterface}
          error={problem("module.canInterface", draft.canInterface)}
          onChange={(canInterface) => onChange({ canInterface })}
        />
        <TextInput
          size="xs"
          label="Channel"
          placeholder="can0"
          classNames={{ input: "num", label: "hint regular" }}
          value={draft.canChannel}
          error={problem("module.canChannel", draft.canChannel)}
          autoComplete="off"
          spellCheck={false}
          onChange={(event) => onChange({ canChannel: event.currentTarget.value })}
        />
      </div>
      <div className={`${css.two} halves start gap-8`}>
        {typed("bitrate", "Bit rate [bit/s]", CAN_BITRATES)}
        {numeric("timeoutS", "Answer within", "s")}
        {numeric("sendId", "The module listens to id")}
        {numeric("receiveId", "It answers under id")}
      </div>
    </>
  );
}
