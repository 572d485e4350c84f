import { Autocomplete, Select, TextInput } from "@mantine/core";
import { IconChevronRight } from "@tabler/icons-react";
import { fixed } from "../../lib/format";
import { StageFields } from "./AxisFields";
import { CHIP_LIMITS, ECHOES, V_ACTUAL_WRITABLE, WIRINGS } from "./chip";
import css from "./connections.module.css";
import type { Draft } from "./draft";
import { EmulatorOptions } from "./EmulatorOptions";
import { OptionalNumber } from "./fields";
import { clockLimits, framesOf, type Model } from "./models";
import { optionsOf } from "./options";
import { PortField } from "./PortField";

const SPI = [
  ["bus", "Bus", ""],
  ["device", "Chip select", ""],
  ["speedHz", "Clock of the bus", "Hz"],
] as const;
/** The chip measures the rate of each datagram: these are what adapters and lines do well. */
const UART_BAUDS = [9600, 19_200, 57_600, 115_200, 230_400, 250_000, 460_800, 500_000];
const ECHO_WORDS: Record<(typeof ECHOES)[number], string> = {
  auto: "found out when connecting",
  on: "yes: one wire both ways",
  off: "no: the adapter takes it off",
};

interface Props {
  draft: Draft;
  model: Model;
  problems: Readonly<Record<string, string>>;
  /** the problem of a field, where it is to be told now */
  problem: (path: string, text: string) => string | undefined;
  onChange: (change: Partial<Draft>) => void;
  /** the emulator's options are open */
  more: boolean;
  onMore: (open: boolean) => void;
}

/** The way to a chip: here, raw datagrams through a socket or on an SPI bus, a UART, or an evaluation board. */
export function ChipLinkFields(props: Props) {
  const { draft, model, problem, onChange } = props;
  return (
    <>
      <Wire {...props} />
      <OptionalNumber
        label="Clock of the chip"
        unit="MHz"
        value={draft.clockMhz}
        limits={clockLimits(model)}
        problem={problem("clockMhz", draft.clockMhz)}
        onChange={(clockMhz) => onChange({ clockMhz })}
      />
    </>
  );
}

function Wire(props: Props) {
  if (framesOf(props.model, props.draft.kind) === "board")
    return (
      <>
        <LinePort {...props} label="Port of the board" />
        <AnswerWithin {...props} limits={CHIP_LIMITS.lineTimeoutS} />
      </>
    );
  switch (props.draft.kind) {
    case "tcp":
      return <Socket {...props} />;
    case "uart":
      return <Uart {...props} />;
    case "spidev":
      return <SpiBus {...props} />;
    default:
      return <EmulatorFields {...props} />;
  }
}

function LinePort({ draft, problem, onChange, label }: Props & { label: string }) {
  return (
    <PortField
      label={label}
      value={draft.module.serialPort}
      problem={problem("module.serialPort", draft.module.serialPort)}
      onChange={(serialPort) => onChange({ module: { ...draft.module, serialPort } })}
    />
  );
}

type TimeLimits = typeof CHIP_LIMITS.timeoutS | typeof CHIP_LIMITS.lineTimeoutS;

function AnswerWithin({ draft, problem, onChange, limits }: Props & { limits: TimeLimits }) {
  return (
    <OptionalNumber
      label="Answer within"
      unit="s"
      value={draft.timeoutS}
      limits={limits}
      problem={problem("timeoutS", draft.timeoutS)}
      onChange={(timeoutS) => onChange({ timeoutS })}
    />
  );
}

function Socket(props: Props) {
  const { draft, problem, onChange } = props;
  return (
    <div className={`${css.tcp} grid start gap-8`}>
      <TextInput
        size="xs"
        label="Host"
        placeholder="127.0.0.1"
        classNames={{ input: "num", label: "hint regular" }}
        value={draft.host}
        error={problem("host", draft.host)}
        autoComplete="off"
        spellCheck={false}
        onChange={(event) => onChange({ host: event.currentTarget.value })}
      />
      <OptionalNumber
        label="Port"
        value={draft.port}
        placeholder="4280"
        limits={CHIP_LIMITS.port}
        problem={problem("port", draft.port)}
        onChange={(port) => onChange({ port })}
      />
      <AnswerWithin {...props} limits={CHIP_LIMITS.timeoutS} />
    </div>
  );
}

function Uart(props: Props) {
  const { draft, model, problem, onChange } = props;
  const set = (change: Partial<Draft["uart"]>) => onChange({ uart: { ...draft.uart, ...change } });
  return (
    <>
      <LinePort {...props} label="Port of the UART" />
      <div className={`${css.three} grid start gap-8`}>
        <Autocomplete
          size="xs"
          label="Baud"
          placeholder={fixed(CHIP_LIMITS.baud.fallback)}
          classNames={{ input: "num", label: "hint regular" }}
          data={UART_BAUDS.map(String)}
          filter={({ options }) => options}
          value={draft.uart.baud}
          error={problem("uart.baud", draft.uart.baud)}
          inputMode="numeric"
          onChange={(baud) => set({ baud })}
        />
        {model.uart === "node" && (
          <OptionalNumber
            label="Node address"
            value={draft.uart.node}
            limits={CHIP_LIMITS.node}
            problem={problem("uart.node", draft.uart.node)}
            onChange={(node) => set({ node })}
          />
        )}
        <AnswerWithin {...props} limits={CHIP_LIMITS.lineTimeoutS} />
      </div>
      <Select
        size="xs"
        label="What is sent comes back as an echo"
        classNames={{ label: "hint regular" }}
        data={ECHOES.map((value) => ({ value, label: ECHO_WORDS[value] }))}
        value={draft.uart.echo}
        allowDeselect={false}
        onChange={(echo) => set({ echo: ECHOES.find((known) => known === echo) ?? "auto" })}
      />
    </>
  );
}

function SpiBus({ draft, problem, onChange }: Props) {
  return (
    <div className={`${css.three} grid start gap-8`}>
      {SPI.map(([part, label, unit]) => (
        <OptionalNumber
          key={part}
          label={label}
          {...(unit === "" ? {} : { unit })}
          value={draft.spi[part]}
          limits={CHIP_LIMITS[part]}
          problem={problem(`spi.${part}`, draft.spi[part])}
          onChange={(text) => onChange({ spi: { ...draft.spi, [part]: text } })}
        />
      ))}
    </div>
  );
}

function EmulatorFields({ draft, model, problems, problem, onChange, more, onMore }: Props) {
  if (optionsOf(model).length > 0)
    return (
      <EmulatorOptions
        model={model}
        options={draft.options}
        problem={problem}
        onChange={(options) => onChange({ options })}
        open={more}
        onOpen={onMore}
      />
    );
  return (
    <>
      <button
        type="button"
        className={`${css.more} row gap-4 p-0 accent`}
        aria-expanded={more}
        onClick={() => onMore(!more)}
      >
        <IconChevronRight size={13} className={css.chevron} data-open={more} aria-hidden />
        Emulator: time, seed{model.axes > 1 && ", wiring"}, writes of V_ACTUAL, stages
      </button>
      {more && (
        <>
          <div className={`${css.two} halves start gap-8`}>
            <OptionalNumber
              label="Chip time runs at"
              unit="× real time"
              value={draft.timeScale}
              limits={CHIP_LIMITS.timeScale}
              problem={problem("timeScale", draft.timeScale)}
              onChange={(timeScale) => onChange({ timeScale })}
            />
            <OptionalNumber
              label="Seed of RAM noise and bit errors"
              value={draft.seed}
              limits={CHIP_LIMITS.seed}
              problem={problem("seed", draft.seed)}
              onChange={(seed) => onChange({ seed })}
            />
          </div>
          {model.axes > 1 && (
            <Select
              size="xs"
              label="How the switches reach REF1 to REF3"
              classNames={{ label: "hint regular" }}
              data={WIRINGS}
              value={draft.wiring || "multiplexed"}
              allowDeselect={false}
              onChange={(wiring) => onChange({ wiring: wiring ?? "" })}
            />
          )}
          <Select
            size="xs"
            label="V_ACTUAL can be written in"
            classNames={{ label: "hint regular" }}
            data={V_ACTUAL_WRITABLE}
            value={draft.vActualWritable || "hold-mode"}
            allowDeselect={false}
            onChange={(value) => onChange({ vActualWritable: value ?? "" })}
          />
          <StageFields draft={draft} problems={problems} onChange={(stages) => onChange({ stages })} />
        </>
      )}
    </>
  );
}
