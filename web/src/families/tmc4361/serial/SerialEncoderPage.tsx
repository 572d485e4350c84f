import { Button, Text } from "@mantine/core";
import { IconBinary } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { api, type Schemas } from "../../../api/client";
import type { Device } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { compact, duration, fixed, frequency } from "../../../lib/format";
import { NoDevice, Waiting } from "../../../lib/NoDevice";
import { NumberField } from "../../../lib/NumberField";
import { Page } from "../../../lib/Page";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { ChipField } from "../../../lib/rows/ChipField";
import { ChipNotices } from "../../../lib/rows/ChipNotices";
import { DeviceNotice } from "../../../lib/rows/DeviceNotice";
import { StagedDrawer } from "../../../lib/rows/StagedDrawer";
import { type ChipRows, useChipRows } from "../../../lib/rows/useChipRows";
import { type Calculation, useCalc } from "../../../lib/useCalc";
import { WarningList } from "../../../lib/Warnings";
import { useSelectedAxis } from "../../../live/selection";
import { useChangeEmulator, useEmulator } from "../../../pages/bench/useEmulator";
import {
  errorsOf,
  halvesOf,
  inputOf,
  kindOf,
  outputOf,
  placeOf,
  type SerialAnswer,
  type SerialQuestion,
} from "./answer";
import { Bits } from "./Bits";

const GROUPS = ["general", "encoder", "serial encoder", "spi output", "driver"] as const;
const NOTHING = { icon: <IconBinary size={22} />, wanted: "a TMC4361" };
const DEFAULT_CLOCK = 16e6;
const LISTEN_HZ = 100e3;

/** A serial encoder at the chip, and the chip as a serial encoder for others. */
export default function SerialEncoderPage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  if (waiting) return <Waiting page="Serial encoder" />;
  if (!device || !entry) return <NoDevice page="Serial encoder" {...NOTHING} />;
  return <SerialEncoder key={key} device={device} axis={entry.index} />;
}

function useAnswer(name: string, question: SerialQuestion | null): Calculation<SerialAnswer> {
  return useCalc<SerialQuestion, SerialAnswer>(`serial-encoder ${name}`, question, (body, signal) =>
    api.POST("/api/v1/calc/serial-encoder", { body, signal }),
  );
}

function SerialEncoder({ device, axis }: { device: Device; axis: number }) {
  const chip = useChipRows(device, axis, GROUPS);
  const clockHz = device.clock_hz ?? DEFAULT_CLOCK;
  const [turns, setTurns] = useState(1);
  const [angle, setAngle] = useState(1);
  const kind = kindOf(chip);
  const input = useAnswer("in", inputOf(chip, clockHz, turns, angle));
  const output = useAnswer("out", outputOf(chip, clockHz, turns, angle));
  const disabled = !chip.known;
  const at = { chip, disabled };
  return (
    <Page name="Serial encoder">
      <DeviceNotice device={device} />
      <ChipNotices chip={chip} device={device} />
      <div className="columns until-75" data-stale={device.state !== "connected"}>
        <div className="column">
          <Card title="Encoder that is read">
            <ChipField {...at} register="GENERAL_CONF" field="serial_enc_in_mode" label="kind" />
            {kind === null ? (
              <Text className="hint">
                An incremental encoder is set on the page Closed loop. Choose SSI or SPI to read an absolute one.
              </Text>
            ) : (
              <DataFields chip={chip} kind={kind} disabled={disabled} />
            )}
          </Card>
          {kind !== null && (
            <Card title="Clock and requests">
              <ClockFields chip={chip} kind={kind} clockHz={clockHz} disabled={disabled} />
            </Card>
          )}
          {kind === "spi" && (
            <Card title="Registers of an SPI encoder" note="a write of the data sends it to the address">
              <div className="halves gap-8">
                <ChipField {...at} register="ENC_IN_DATA" field="serial_addr_bits" />
                <ChipField {...at} register="ENC_IN_DATA" field="serial_data_bits" />
                <ChipField {...at} register="ADDR_TO_ENC" />
                <ChipField {...at} register="DATA_TO_ENC" />
              </div>
            </Card>
          )}
        </div>
        <div className="column ahead">
          <Card title="An answer" note="first bit first">
            {kind === null ? (
              <Text className="hint">No serial encoder is chosen.</Text>
            ) : (
              <AnswerView
                label="Bits of the encoder's answer"
                found={input}
                place={{ turns, angle, onTurns: setTurns, onAngle: setAngle }}
              />
            )}
          </Card>
          <Errors device={device} axis={axis} multiCycle={chip.planned("ENC_IN_CONF", "ssi_multi_cycle_data") === 1} />
          {device.emulated && <OnShaft device={device} chip={chip} kind={kind} />}
          <Card title="Encoder output for others" note="SSI, at the pins of the driver's SPI">
            <OutputFields chip={chip} disabled={disabled} clockHz={clockHz} />
            <AnswerView label="Bits that a listener gets" found={output} />
            {device.emulated && output.result && (
              <Listener
                device={device}
                names={output.result.names}
                gray={chip.held("ENC_IN_CONF", "enc_out_gray") === 1}
              />
            )}
            <Text className="hint">
              While it is on, the driver cannot be reached over SPI: it needs step and direction. That the output gives
              ENC_POS, turns first, is our reading: the data sheet at hand ends before that chapter.
            </Text>
          </Card>
        </div>
      </div>
      <StagedDrawer chip={chip} device={device} />
    </Page>
  );
}

interface FieldsProps {
  chip: ChipRows;
  kind: "ssi" | "spi";
  disabled: boolean;
}

const bits = (value: number) => (value === 0 ? "1 bit" : `${value + 1} bits`);

function DataFields({ chip, kind, disabled }: FieldsProps) {
  const at = { chip, disabled };
  const single = (chip.planned("ENC_IN_DATA", "single_turn_res") ?? 0) + 1;
  const multi = chip.planned("ENC_IN_CONF", "multi_turn_in_en") === 1;
  const counts = chip.planned("ENC_IN_RES", "ENC_IN_RES");
  return (
    <>
      <div className="halves start gap-8 mt-4">
        <ChipField {...at} register="ENC_IN_DATA" field="single_turn_res" label="angle" physical={bits} />
        <ChipField
          {...at}
          register="ENC_IN_DATA"
          field="multi_turn_res"
          label="turns"
          physical={(value) => (multi ? bits(value) : "not sent")}
        />
        <ChipField {...at} register="ENC_IN_DATA" field="status_bit_cnt" />
        <ChipField {...at} register="ENC_IN_RES" field="ENC_IN_RES" label="counts a turn" />
      </div>
      {counts !== 2 ** single && single < 31 && (
        <Button
          size="compact-xs"
          variant="default"
          my={4}
          disabled={disabled}
          onClick={() => chip.put("ENC_IN_RES", "ENC_IN_RES", 2 ** single)}
        >
          {compact(2 ** single, 10)} counts a turn, as the angle has bits
        </Button>
      )}
      <div className="grid gap-6 my-8">
        <ChipField {...at} register="ENC_IN_CONF" field="multi_turn_in_en" label="turns are sent" />
        {multi ? (
          <ChipField {...at} register="ENC_IN_CONF" field="multi_turn_in_signed" label="and signed" />
        ) : (
          <ChipField {...at} register="ENC_IN_CONF" field="calc_multi_turn_behav" label="turns are counted here" />
        )}
        <ChipField {...at} register="ENC_IN_CONF" field="left_aligned_data" label="status bits last" />
        <ChipField {...at} register="ENC_IN_CONF" field="invert_enc_dir" label="counts the other way" />
        {kind === "ssi" ? (
          <>
            <ChipField {...at} register="ENC_IN_CONF" field="ssi_gray_code_en" label="Gray code" />
            <ChipField {...at} register="ENC_IN_CONF" field="ssi_multi_cycle_data" label="asked twice, compared" />
          </>
        ) : (
          <>
            <ChipField {...at} register="ENC_IN_CONF" field="spi_data_on_cs" label="first bit with chip select" />
            <ChipField {...at} register="ENC_IN_CONF" field="spi_low_before_cs" label="clock low first" />
          </>
        )}
      </div>
    </>
  );
}

function ClockFields({ chip, kind, disabled, clockHz }: FieldsProps & { clockHz: number }) {
  const at = { chip, disabled };
  const time = (clocks: number) => duration(clocks / clockHz);
  const high = chip.planned("SER_CLK_IN_HIGH_LOW", "SER_CLK_IN_HIGH");
  const low = chip.planned("SER_CLK_IN_HIGH_LOW", "SER_CLK_IN_LOW");
  const limited = chip.planned("ENC_IN_CONF", "serial_enc_variation_limit") === 1;
  return (
    <>
      <div className="halves start gap-8">
        <NumberField
          label="Clock of the encoder"
          unit="kHz"
          min={clockHz / 2 / 0xffff / 1e3}
          max={clockHz / 2 / 1e3}
          step={10}
          value={high === null || low === null || high + low === 0 ? null : clockHz / (high + low) / 1e3}
          placeholder="?"
          show={(khz) => compact(khz)}
          disabled={disabled}
          onChange={(khz) => {
            const halves = halvesOf(khz * 1e3, clockHz);
            chip.put("SER_CLK_IN_HIGH_LOW", "SER_CLK_IN_HIGH", halves.high);
            chip.put("SER_CLK_IN_HIGH_LOW", "SER_CLK_IN_LOW", halves.low);
          }}
          data-testid="encoder-clock"
        />
        <ChipField {...at} register="SER_PTIME" label="between requests" physical={time} />
        <ChipField {...at} register="SER_CLK_IN_HIGH_LOW" field="SER_CLK_IN_HIGH" physical={time} />
        <ChipField {...at} register="SER_CLK_IN_HIGH_LOW" field="SER_CLK_IN_LOW" physical={time} />
        {kind === "ssi" && (
          <>
            <ChipField {...at} register="SSI_IN_CLK_DELAY___SSI_IN_WTIME" field="SSI_IN_CLK_DELAY" physical={time} />
            <ChipField {...at} register="SSI_IN_CLK_DELAY___SSI_IN_WTIME" field="SSI_IN_WTIME" physical={time} />
          </>
        )}
      </div>
      <div className="grid gap-6 my-8">
        <ChipField {...at} register="ENC_IN_CONF" field="serial_enc_variation_limit" label="jumps are dropped" />
      </div>
      {limited && (
        <ChipField
          {...at}
          register="SER_ENC_VARIATION___CL_CYCLE"
          field="SER_ENC_VARIATION"
          label="greatest jump"
          physical={(value) => (value === 0 ? "0: any" : `${fixed((value / 2048) * 360, 2)} ° of a turn`)}
        />
      )}
    </>
  );
}

function OutputFields({ chip, disabled, clockHz }: { chip: ChipRows; disabled: boolean; clockHz: number }) {
  const at = { chip, disabled };
  return (
    <>
      <div className="grid gap-6 mb-4">
        <ChipField {...at} register="GENERAL_CONF" field="serial_enc_out_enable" label="output on" />
        <ChipField {...at} register="ENC_IN_CONF" field="multi_turn_out_en" label="turns are sent" />
        <ChipField {...at} register="ENC_IN_CONF" field="enc_out_gray" label="Gray code" />
      </div>
      <div className="halves start gap-8 mb-4">
        <ChipField {...at} register="ENC_OUT_DATA" field="single_turn_res_out" label="angle" physical={bits} />
        <ChipField {...at} register="ENC_OUT_DATA" field="multi_turn_res_out" label="turns" physical={bits} />
        <ChipField {...at} register="ENC_OUT_RES" label="counts a turn" />
        <ChipField
          {...at}
          register="SPI_OUT_CONF"
          field="ssi_out_mtime"
          label="monoflop"
          physical={(clocks) => duration(clocks / clockHz)}
        />
        <ChipField {...at} register="GENERAL_CONF" field="serial_enc_out_diff_disable" />
      </div>
    </>
  );
}

interface Place {
  turns: number;
  angle: number;
  onTurns: (turns: number) => void;
  onAngle: (angle: number) => void;
}

interface AnswerProps {
  label: string;
  found: Calculation<SerialAnswer>;
  /** whose answer is shown; without it only the bits are */
  place?: Place;
}

function AnswerView({ label, found, place }: AnswerProps) {
  const { result, stale, error, retry } = found;
  return (
    <div className={stale ? "stale" : undefined} aria-busy={stale}>
      {error !== null && <ProblemAlert error={error} doing="Calculating the answer" retry={retry} />}
      {place && (
        <div className="lines-12 mb-4">
          <NumberField
            label="Turns"
            integer
            min={-(2 ** 31)}
            max={2 ** 31 - 1}
            value={place.turns}
            onChange={place.onTurns}
            w={120}
          />
          <NumberField
            label="Angle"
            unit="counts"
            integer
            min={0}
            max={2 ** 32 - 1}
            value={place.angle}
            onChange={place.onAngle}
            w={150}
          />
        </div>
      )}
      {result && <Bits label={label} names={result.names} bits={result.bits} />}
      {result && place && <Facts result={result} />}
    </div>
  );
}

function Facts({ result }: { result: SerialAnswer }) {
  const rows: readonly [string, string][] = [
    ["Clock", frequency(result.bit_hz)],
    ["One answer", `${result.names.length} clocks, ${duration(result.answer_s)}`],
    ["A request every", duration(result.period_s)],
    ["The clock rests for", duration(result.pause_s)],
    ["One count", `${compact(result.angle_deg)} °`],
    ["Turns told apart", compact(result.turns, 10)],
    ["Fastest", result.speed_rpm === null ? "no limit by the encoder" : compact(result.speed_rpm, 4, "rpm")],
  ];
  return (
    <>
      <table className="figures" data-testid="serial-facts">
        <tbody>
          {rows.map(([name, value]) => (
            <tr key={name}>
              <th scope="row">{name}</th>
              <td className="num">{value}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <WarningList texts={result.warnings} />
    </>
  );
}

/** What the chip says of the encoder's answers. */
function Errors({ device, axis, multiCycle }: { device: Device; axis: number; multiCycle: boolean }) {
  const connected = device.state === "connected";
  const state = useQuery({
    queryKey: ["axis-flags", device.id, axis],
    queryFn: () => api.GET("/api/v1/devices/{device}/axes/{axis}", { path: { device: device.id, axis } }),
    enabled: connected,
    refetchInterval: 1000,
  });
  const errors = errorsOf(state.data?.flags ?? {}, multiCycle);
  const wrong = errors.filter(({ set }) => set);
  return (
    <Card title="Errors" note={connected ? undefined : "not connected"}>
      {state.isError && connected && (
        <ProblemAlert error={state.error} doing="Reading the flags" retry={() => void state.refetch()} />
      )}
      {state.data && (
        <ul className="list" aria-live="polite" data-testid="serial-errors">
          {wrong.length === 0 && <li className="good text-12">None: {errors.map(({ name }) => name).join(", ")}</li>}
          {wrong.map(({ name, text }) => (
            <li key={name} className="fault text-12">
              <span className="mono">{name}</span>: {text}
            </li>
          ))}
        </ul>
      )}
    </Card>
  );
}

/** The emulated shaft: which encoder it has, and another one put there. */
function OnShaft({ device, chip, kind }: { device: Device; chip: ChipRows; kind: "ssi" | "spi" | null }) {
  const emulator = useEmulator(device);
  const change = useChangeEmulator(device.id);
  const encoder = (emulator.data as Schemas["Tmc4361State"] | undefined)?.encoder;
  if (encoder === undefined) return null;
  const single = (chip.planned("ENC_IN_DATA", "single_turn_res") ?? 0) + 1;
  const turns = chip.planned("ENC_IN_CONF", "multi_turn_in_en") === 1;
  const fits = kind !== null && single >= 2 && single <= 24;
  return (
    <Card title="On the emulated shaft">
      <Text className="hint" data-testid="on-shaft">
        {encoder.kind === "abn"
          ? `An incremental encoder, ${fixed(encoder.counts_per_turn / 4)} lines.`
          : `${encoder.kind.toUpperCase()}, ${encoder.single_turn_bits} bits of angle, ${encoder.multi_turn_bits} of turns${
              encoder.gray ? ", Gray code" : ""
            }.`}
      </Text>
      <div className="lines-12 mt-4">
        <Button
          variant="default"
          disabled={!fits || change.isPending}
          onClick={() =>
            kind !== null &&
            change.mutate({
              encoder: {
                kind,
                single_turn_bits: single,
                multi_turn_bits: turns ? Math.min(24, (chip.planned("ENC_IN_DATA", "multi_turn_res") ?? 0) + 1) : 0,
                gray: chip.planned("ENC_IN_CONF", "ssi_gray_code_en") === 1,
                status_bit_count: chip.planned("ENC_IN_DATA", "status_bit_cnt") ?? 0,
              },
            })
          }
          data-testid="put-on-shaft"
        >
          Put one there that answers as set
        </Button>
        <Button
          variant="default"
          disabled={encoder.kind === "abn" || change.isPending}
          onClick={() => change.mutate({ encoder: { spoil_next: 1 << (encoder.single_turn_bits - 1) } })}
        >
          Spoil its next answer
        </Button>
      </div>
      {change.isError && <ProblemAlert error={change.error} doing="Changing the encoder" onClose={change.reset} />}
    </Card>
  );
}

/** Somebody who clocks at the emulated output. */
function Listener({ device, names, gray }: { device: Device; names: readonly string[]; gray: boolean }) {
  const change = useChangeEmulator(device.id);
  const state = change.data as Schemas["Tmc4361State"] | undefined;
  const heard = state?.encoder_output.heard ?? "";
  const place = heard === "" ? null : placeOf(heard, names, gray);
  return (
    <div className="lines-12 baseline my-8 text-12">
      <Button
        variant="default"
        size="compact-xs"
        loading={change.isPending}
        onClick={() => change.mutate({ listen: { clocks: names.length, rate_hz: LISTEN_HZ } })}
        data-testid="listen"
      >
        Clock it, {frequency(LISTEN_HZ)}
      </Button>
      {heard !== "" && (
        <span className="num anywhere" data-testid="heard">
          {heard}
          {state?.encoder_output.enabled === false
            ? ", the line at rest: the output is off"
            : place === null
              ? ""
              : `, turn ${place.turns}, count ${place.angle}${state?.encoder_output.repeated ? ", repeated" : ""}`}
        </span>
      )}
      {change.isError && <ProblemAlert error={change.error} doing="Listening" onClose={change.reset} />}
    </div>
  );
}
