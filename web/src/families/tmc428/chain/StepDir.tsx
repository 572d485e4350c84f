import { Button, Slider, Switch } from "@mantine/core";
import { useElementSize } from "@mantine/hooks";
import { IconUpload } from "@tabler/icons-react";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api, type Schemas } from "../../../api/client";
import type { Device } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { duration, fixed, withUnit } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { useWork } from "../../../lib/useWork";
import { Savable } from "../../../plots/Savable";
import classes from "./Chain.module.css";
import { pulseLength, stepRateMax } from "./chain";

interface Settings {
  STPDIV_4210: number;
  step_half: number;
  inv_stp: number;
  inv_dir: number;
  en_sd: number;
}

type Field = keyof Settings;

const RESET: Settings = { STPDIV_4210: 15, step_half: 0, inv_stp: 0, inv_dir: 0, en_sd: 0 };
const INTERFACE = "IF_CONFIGURATION_4210";
const GLOBAL = "STEPPER_MOTOR_GLOBAL_PARAMETER_REGISTER";

const SWITCHES: readonly [field: Field, label: string][] = [
  ["en_sd", "interface on (en_sd)"],
  ["step_half", "a step at each edge (step_half)"],
  ["inv_stp", "STEP inverted (inv_stp)"],
  ["inv_dir", "DIR inverted (inv_dir)"],
];

interface Held {
  settings: Settings;
  /** highest step rate of the axis as it is set [pps] */
  rate: number;
}

export function heldBy(readings: readonly Schemas["RegisterReading"][], clockHz: number): Held | null {
  const values = new Map<string, number>();
  for (const reading of readings) {
    values.set(reading.name, reading.value);
    for (const [field, value] of Object.entries(reading.fields)) values.set(field, value);
  }
  const settings = { ...RESET };
  for (const field of Object.keys(RESET) as Field[]) {
    const value = values.get(field);
    if (value === undefined) return null;
    settings[field] = value;
  }
  const velocity = values.get("V_MAX") ?? 0;
  return { settings, rate: (clockHz * velocity) / (2 ** (values.get("PULSE_DIV") ?? 0) * 65536) };
}

/** Points of a signal that is high in the given stretches of time. */
function wave(
  highs: readonly [number, number][],
  end: number,
  inverted: boolean,
  x: (t: number) => number,
  top: number,
) {
  const level = (high: boolean) => (high !== inverted ? top : top + 30);
  let path = `M${x(0)},${level(highs[0]?.[0] === 0)}`;
  for (const [from, to] of highs) {
    path += `H${x(from)}V${level(true)}H${x(Math.min(to, end))}`;
    if (to < end) path += `V${level(false)}`;
  }
  return `${path}H${x(end)}`;
}

function Timing({ settings, clockHz, rate }: { settings: Settings; clockHz: number; rate: number }) {
  const { ref, width } = useElementSize<HTMLDivElement>();
  const pulse = pulseLength(settings.STPDIV_4210, clockHz);
  const period = rate > 0 ? 1 / rate : pulse * 4;
  const half = settings.step_half === 1;
  const end = 2.6 * period;
  const left = 52;
  const inner = Math.max(120, width - left - 12);
  const x = (t: number) => left + (t / end) * inner;
  const starts = [0.25, 1.25, 2.25].map((share) => share * period);
  const highs: [number, number][] = half
    ? [
        [starts[0] ?? 0, starts[1] ?? 0],
        [starts[2] ?? 0, end],
      ]
    : starts.map((start) => [start, start + Math.min(pulse, period)]);
  const stepTop = 34;
  const dirTop = 104;
  const first = starts[0] ?? 0;
  return (
    <Savable name="Timing of STEP and DIR">
      <div ref={ref}>
        <svg
          width="100%"
          height={168}
          role="img"
          aria-label={`Timing of STEP and DIR: pulses of ${duration(pulse)}, one each ${duration(period)}`}
        >
          <text className="text-12 bold mono fill-text" x={4} y={stepTop + 19}>
            STEP
          </text>
          <text className="text-12 bold mono fill-text" x={4} y={dirTop + 19}>
            DIR
          </text>
          {starts.map((start) => (
            <line
              key={start}
              stroke="var(--line)"
              strokeDasharray="2 3"
              x1={x(start)}
              x2={x(start)}
              y1={14}
              y2={dirTop + 40}
            />
          ))}
          <path className="fill-none stroke-accent stroke-2" d={wave(highs, end, settings.inv_stp === 1, x, stepTop)} />
          <path
            className="fill-none stroke-accent stroke-2"
            d={wave([[0, end]], end, settings.inv_dir === 1, x, dirTop)}
          />
          <text className="tick" x={x(first + period / 2)} y={20} textAnchor="middle">
            a step each {duration(period)}
          </text>
          <path className="stroke-dim stroke-1" d={`M${x(first)},24H${x(first + period)}`} />
          {!half && (
            <text className="tick" x={x(first) + 4} y={stepTop + 46}>
              pulse {duration(pulse)}
            </text>
          )}
          <text className="tick" x={x(end)} y={160} textAnchor="end">
            time, to scale at the highest velocity set
          </text>
        </svg>
      </div>
    </Savable>
  );
}

/** The TMC4210 has no chain: it steps one driver through STEP and DIR. What these do, and how long a pulse is. */
export function StepDir({ device }: { device: Device }) {
  const queries = useQueryClient();
  const connected = device.state === "connected";
  const readings = useQuery({
    queryKey: ["registers", device.id, null],
    queryFn: ({ signal }) => api.GET("/api/v1/devices/{device}/registers", { path: { device: device.id }, signal }),
    enabled: connected,
    refetchInterval: 1000,
  });
  const held = readings.data ? heldBy(readings.data, device.clock_hz) : null;
  const [edits, setEdits] = useState<Partial<Settings>>({});
  const settings: Settings = { ...RESET, ...held?.settings, ...edits };
  const rate = held?.rate ?? 0;
  const changed = (Object.keys(edits) as Field[]).filter((field) => edits[field] !== held?.settings[field]);
  const set = (field: Field, value: number) => setEdits({ ...edits, [field]: value });

  const send = useWork(
    async () => {
      const fields = (register: string) =>
        Object.fromEntries(
          changed
            .filter((field) => (field === "STPDIV_4210" ? GLOBAL : INTERFACE) === register)
            .map((field) => [field, settings[field]]),
        );
      const writes = [GLOBAL, INTERFACE]
        .map((name) => ({ name, fields: fields(name) }))
        .filter((write) => Object.keys(write.fields).length > 0);
      return await api.POST("/api/v1/devices/{device}/registers", { path: { device: device.id }, body: { writes } });
    },
    {
      onSuccess: (answer) => {
        if (answer.failed === null) setEdits({});
      },
      onSettled: () => queries.invalidateQueries({ queryKey: ["registers", device.id] }),
    },
  );

  const pulse = pulseLength(settings.STPDIV_4210, device.clock_hz);
  const most = stepRateMax(settings.STPDIV_4210, device.clock_hz);
  const half = settings.step_half === 1;
  const tooFast = !half && rate > most;

  return (
    <div className="columns until-62">
      <Card
        title="Step and direction"
        note={
          connected
            ? changed.length === 0
              ? "as the chip is set"
              : `${changed.length} values differ from the chip's`
            : `${device.name} is not connected: connect it under Connections`
        }
        actions={
          <Button
            leftSection={<IconUpload size={14} aria-hidden />}
            disabled={!connected || changed.length === 0}
            loading={send.isPending}
            onClick={() => send.mutate()}
          >
            Send
          </Button>
        }
      >
        <p className="text-13 m-0 mb-8">
          The TMC4210 drives no chain of SPI drivers. It gives one driver a pulse on STEP for each microstep, and the
          way on DIR; coil currents, microsteps and decay are the driver's own matter. So there is no datagram to
          configure here, only how long a pulse is and which level means what.
        </p>
        <div className="control-line text-12">
          <span className="num">STPDIV</span>
          <Slider
            min={0}
            max={15}
            value={settings.STPDIV_4210}
            thumbLabel="STPDIV, the length of a step pulse"
            onChange={(value) => set("STPDIV_4210", value)}
          />
          <NumberField
            aria-label="STPDIV, the length of a step pulse"
            value={settings.STPDIV_4210}
            min={0}
            max={15}
            integer
            onChange={(value) => set("STPDIV_4210", value)}
          />
        </div>
        <div className="lines-16 mid my-8 text-12">
          {SWITCHES.map(([field, label]) => (
            <Switch
              key={field}
              label={label}
              checked={settings[field] === 1}
              onChange={(event) => set(field, event.currentTarget.checked ? 1 : 0)}
            />
          ))}
        </div>
        {settings.en_sd === 0 && (
          <p className="caution my-4">en_sd is off: no pulse leaves the chip. Switch the interface on to move.</p>
        )}
        {readings.isError && (
          <ProblemAlert error={readings.error} doing="Reading the chip" retry={() => void readings.refetch()} />
        )}
        {send.isError && <ProblemAlert error={send.error} doing="Sending the settings" onClose={send.reset} />}
        {send.data?.failed && <ProblemAlert error={send.data.failed} doing="Sending the settings" />}
      </Card>
      <Card title="Pulse timing" note={`16 · (1 + STPDIV) clocks at ${fixed(device.clock_hz / 1e6, 1, "MHz")}`}>
        <Timing settings={settings} clockHz={device.clock_hz} rate={rate} />
        <dl className={`${classes.rates} stacked grid gap-8 m-0 mt-8`}>
          <div>
            <dt>pulse</dt>
            <dd className="num text-16 bold">{half ? "none: an edge" : duration(pulse)}</dd>
          </div>
          <div>
            <dt>steps, at most</dt>
            <dd className="num text-16 bold">{withUnit(half ? device.clock_hz / 32 : most, "pps")}</dd>
          </div>
          <div>
            <dt>highest velocity set</dt>
            <dd className="num text-16 bold">{held ? withUnit(rate, "pps") : "–"}</dd>
          </div>
        </dl>
        <p className={`my-4 ${tooFast ? "caution" : "hint"}`}>
          {tooFast
            ? "At the highest velocity a pulse and a pause of its length do not fit: choose a smaller STPDIV, or each edge as a step."
            : "A pulse and a pause of its length fit at the highest velocity. The driver's sheet says how long it needs them."}
        </p>
      </Card>
    </div>
  );
}
