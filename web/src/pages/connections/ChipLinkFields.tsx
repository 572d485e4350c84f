import { Select, TextInput } from "@mantine/core";
import { IconChevronRight } from "@tabler/icons-react";
import type { ChipModel } from "../../lib/family";
import { StageFields } from "./AxisFields";
import css from "./connections.module.css";
import { clockLimits, type Draft, LIMITS, WIRINGS } from "./draft";
import { OptionalNumber } from "./fields";
import { PortField } from "./PortField";

const SPI = [
  ["bus", "Bus", ""],
  ["device", "Chip select", ""],
  ["speedHz", "Clock of the bus", "Hz"],
] as const;

interface Props {
  draft: Draft;
  model: ChipModel;
  problems: Readonly<Record<string, string>>;
  /** the problem of a field, where it is to be told now */
  problem: (path: string, text: string) => string | undefined;
  onChange: (change: Partial<Draft>) => void;
  /** the emulator's options are open */
  more: boolean;
  onMore: (open: boolean) => void;
}

/** The way to a chip: here, raw datagrams through a socket or on an SPI bus, or an evaluation board. */
export function ChipLinkFields({ draft, model, problems, problem, onChange, more, onMore }: Props) {
  return (
    <>
      {draft.kind === "tcp" ? (
        <div className={css.tcp}>
          <TextInput
            size="xs"
            label="Host"
            placeholder="127.0.0.1"
            classNames={{ input: "num", label: css.label }}
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
            limits={LIMITS.port}
            problem={problem("port", draft.port)}
            onChange={(port) => onChange({ port })}
          />
          <OptionalNumber
            label="Answer within"
            unit="s"
            value={draft.timeoutS}
            limits={LIMITS.timeoutS}
            problem={problem("timeoutS", draft.timeoutS)}
            onChange={(timeoutS) => onChange({ timeoutS })}
          />
        </div>
      ) : draft.kind === "landungsbruecke" ? (
        <>
          <PortField
            label="Port of the Landungsbrücke"
            value={draft.module.serialPort}
            problem={problem("module.serialPort", draft.module.serialPort)}
            onChange={(serialPort) => onChange({ module: { ...draft.module, serialPort } })}
          />
          <OptionalNumber
            label="Answer within"
            unit="s"
            value={draft.timeoutS}
            limits={LIMITS.boardTimeoutS}
            problem={problem("timeoutS", draft.timeoutS)}
            onChange={(timeoutS) => onChange({ timeoutS })}
          />
        </>
      ) : draft.kind === "spidev" ? (
        <div className={css.three}>
          {SPI.map(([part, label, unit]) => (
            <OptionalNumber
              key={part}
              label={label}
              {...(unit === "" ? {} : { unit })}
              value={draft.spi[part]}
              limits={LIMITS[part]}
              problem={problem(`spi.${part}`, draft.spi[part])}
              onChange={(text) => onChange({ spi: { ...draft.spi, [part]: text } })}
            />
          ))}
        </div>
      ) : (
        <>
          <button type="button" className={css.more} aria-expanded={more} onClick={() => onMore(!more)}>
            <IconChevronRight size={13} className={css.chevron} data-open={more} aria-hidden />
            Emulator: time, seed{model === "tmc428" && ", wiring"}
            {draft.stages.length > 0 && ", stages"}
          </button>
          {more && (
            <>
              <div className={css.two}>
                <OptionalNumber
                  label="Chip time runs at"
                  unit="× real time"
                  value={draft.timeScale}
                  limits={LIMITS.timeScale}
                  problem={problem("timeScale", draft.timeScale)}
                  onChange={(timeScale) => onChange({ timeScale })}
                />
                <OptionalNumber
                  label="Seed of RAM noise and bit errors"
                  value={draft.seed}
                  limits={LIMITS.seed}
                  problem={problem("seed", draft.seed)}
                  onChange={(seed) => onChange({ seed })}
                />
              </div>
              {model === "tmc428" && (
                <Select
                  size="xs"
                  label="How the switches reach REF1 to REF3"
                  classNames={{ label: css.label }}
                  data={WIRINGS}
                  value={draft.wiring || "multiplexed"}
                  allowDeselect={false}
                  onChange={(wiring) => onChange({ wiring: wiring ?? "" })}
                />
              )}
              {draft.stages.length > 0 && (
                <StageFields draft={draft} problems={problems} onChange={(stages) => onChange({ stages })} />
              )}
            </>
          )}
        </>
      )}
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
