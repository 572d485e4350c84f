import { Badge, Box, Button, CopyButton, Select, Switch } from "@mantine/core";
import { IconCopy, IconDownload, IconPlus, IconTrash, IconUpload } from "@tabler/icons-react";
import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useMemo, useState } from "react";
import { api, type Schemas } from "../../../api/client";
import { can, type Device, useDevices } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { enter } from "../../../lib/history/history";
import { Page } from "../../../lib/Page";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { useCalc } from "../../../lib/useCalc";
import { useSessionKept } from "../../../lib/useKept";
import { useWork } from "../../../lib/useWork";
import { useSelection } from "../../../live/selection";
import { BitDetail } from "./BitDetail";
import classes from "./Chain.module.css";
import { ChainStrip } from "./ChainStrip";
import { ChipSelects } from "./ChipSelects";
import { Composer } from "./Composer";
import {
  BITS_MAX,
  type Bit,
  byMotor,
  CUSTOM,
  customOf,
  DECAYING,
  DRIVERS_MAX,
  type Driver,
  differing,
  driversOf,
  insertBit,
  KNOWN,
  known,
  moveBit,
  named,
  removeBit,
  request,
  setSignal,
} from "./chain";
import { Frequencies } from "./Frequencies";
import { StepDir } from "./StepDir";

const NONE: ReadonlySet<number> = new Set();
/** Height of a strip of three drivers [px]: what comes below it stays where it is when it comes. */
const STRIP = { base: 597, sm: 195 };
const START: Driver[] = [known("tmc236"), known("tmc236"), known("tmc236")];

/** clk2_div as the chip has it, with the other global registers. */
function useClk2Div(device: Device | undefined): number | null {
  const id = device?.id ?? "";
  const reading = useQuery({
    queryKey: ["registers", id, "global"],
    queryFn: ({ signal }) =>
      api.GET("/api/v1/devices/{device}/registers/{name}", {
        path: { device: id, name: "stepper_motor_global_parameter_register" },
        signal,
      }),
    enabled: device?.state === "connected",
    refetchInterval: 3000,
  });
  return reading.data?.fields.clk2_div ?? null;
}

function Editor({ device }: { device: Device | undefined }) {
  const id = device?.id ?? "";
  const connected = device?.state === "connected";
  const queries = useQueryClient();
  const [drivers, put] = useSessionKept<Driver[]>(`stepscope.chain.${id}`, START);
  const [selected, setSelected] = useState<number | null>(null);
  const [hovered, setHovered] = useState<number | null>(null);
  const [ownClk2Div, setClk2Div] = useState<number | null>(null);
  const [ownRampDivs, setRampDivs] = useState<number[] | null>(null);

  const chipClk2Div = useClk2Div(device);
  const clk2Div = ownClk2Div ?? chipClk2Div ?? 7;
  const rampDivs = ownRampDivs ?? [0, 1, 2].map((axis) => device?.axes[axis]?.ramp_div ?? 7);

  const chip = useQuery({
    queryKey: ["driver-chain", id],
    queryFn: ({ signal }) => api.GET("/api/v1/devices/{device}/driver-chain", { path: { device: id }, signal }),
    enabled: connected,
    refetchInterval: 3000,
  });
  const held = connected ? chip.data : undefined;

  const { result, stale, error, retry } = useCalc<Schemas["ChainRequest"], Schemas["ChainDesign"]>(
    "driver-chain",
    {
      drivers: request(drivers),
      clock_hz: device?.clock_hz ?? 16e6,
      clk2_div: clk2Div,
      ramp_divs: rampDivs,
    },
    (body, signal) => api.POST("/api/v1/calc/driver-chain", { body, signal }),
  );

  const send = useWork(
    () =>
      api.PUT("/api/v1/devices/{device}/driver-chain", { path: { device: id }, body: { drivers: request(drivers) } }),
    {
      onSuccess: (table) => {
        queries.setQueryData(["driver-chain", id], table);
        void queries.invalidateQueries({ queryKey: ["registers", id] });
      },
    },
  );

  const different = useMemo(() => (result && held ? differing(result, held) : NONE), [result, held]);
  const sentMatches = send.data && result ? differing(send.data, result).size === 0 : null;
  const bits = useMemo(() => named(result?.bits ?? [], drivers), [result, drivers]);
  const motors = useMemo(() => byMotor(bits), [bits]);
  const shown = hovered ?? selected;
  const bit = shown === null ? null : (bits[shown] ?? null);
  const place = bit ? bit.position - (motors[bit.motor]?.[0]?.position ?? 0) : 0;
  const owner = bit ? drivers[bit.motor] : undefined;

  const setDrivers = (next: Driver[], what = "drivers") =>
    enter({ put, before: drivers, next }, { label: `Design the driver chain: ${what}`, of: "chain", merge: null });
  const change = (motor: number, next: Driver) => setDrivers(drivers.map((old, at) => (at === motor ? next : old)));
  const edit = (motor: number, action: (driver: Driver) => Driver) => {
    const driver = drivers[motor];
    if (driver?.driver === CUSTOM) change(motor, action(driver));
  };
  const adopt = held ? driversOf(held) : null;
  const anyCustom = drivers.some((driver) => driver.driver === CUSTOM);

  function choose(motor: number, name: string) {
    const old = drivers[motor];
    if (!old) return;
    if (name === CUSTOM) change(motor, customOf(motors[motor] ?? []));
    else change(motor, known(name, old.fastDecay));
  }

  const heading = (motor: number, bits: readonly Bit[]) => {
    const driver = drivers[motor];
    if (!driver) return null;
    return (
      <>
        <Badge circle variant="default">
          {motor + 1}
        </Badge>
        <Select
          aria-label={`Driver ${motor + 1}`}
          w={98}
          data={[
            ...KNOWN.map((name) => ({ value: name, label: name.toUpperCase() })),
            { value: CUSTOM, label: "custom" },
          ]}
          value={driver.driver}
          onChange={(name) => name && choose(motor, name)}
        />
        {DECAYING.includes(driver.driver) && (
          <Switch
            label="fast decay"
            checked={driver.fastDecay}
            onChange={(event) => change(motor, { ...driver, fastDecay: event.currentTarget.checked })}
          />
        )}
        <span className="num hint push">{bits.length} bits</span>
        <Button
          size="compact-xs"
          variant="subtle"
          color="gray"
          px={4}
          aria-label={`Remove driver ${motor + 1}`}
          disabled={drivers.length === 1}
          onClick={() => setDrivers(drivers.filter((_, at) => at !== motor))}
        >
          <IconTrash size={14} />
        </Button>
      </>
    );
  };

  const why =
    device === undefined
      ? "No device: the chain can be designed without one; add a TMC428 under Connections to send it."
      : connected
        ? null
        : `${device.name} is not connected: the design stays, connect it under Connections to send it.`;

  return (
    <Page name="Driver chain">
      <div className="grid gap-8">
        <Card
          title="Chain"
          note={
            <span className={stale ? "stale" : undefined}>
              {result
                ? `${result.length_bits ?? "endless"} bits, LSMD ${result.lsmd}, in the order in which they are sent`
                : ""}
            </span>
          }
          actions={
            <>
              <Button
                variant="default"
                leftSection={<IconPlus size={14} aria-hidden />}
                disabled={drivers.length >= DRIVERS_MAX}
                onClick={() => setDrivers([...drivers, known("tmc236")])}
              >
                Driver
              </Button>
              <Button
                variant="default"
                leftSection={<IconDownload size={14} aria-hidden />}
                disabled={adopt === null}
                onClick={() => adopt && setDrivers(adopt, "as the chip has it")}
              >
                Read from chip
              </Button>
              <Button
                leftSection={<IconUpload size={14} aria-hidden />}
                disabled={
                  !connected || !result || stale || error !== null || (held !== undefined && different.size === 0)
                }
                loading={send.isPending}
                onClick={() => send.mutate()}
              >
                Send to chip
              </Button>
            </>
          }
        >
          {error !== null && <ProblemAlert error={error} doing="Building the chain" retry={retry} />}
          {send.isError && <ProblemAlert error={send.error} doing="Sending the chain" onClose={send.reset} />}
          <Box mih={STRIP} className={stale ? "stale" : undefined} aria-busy={stale}>
            {result && (
              <ChainStrip
                label="Chain as designed"
                bits={bits}
                heading={heading}
                selected={selected}
                onSelect={setSelected}
                onHover={setHovered}
                different={different}
                onMove={anyCustom ? (motor, from, to) => edit(motor, (driver) => moveBit(driver, from, to)) : undefined}
                onDelete={
                  anyCustom
                    ? (motor, at) =>
                        edit(motor, (driver) => (driver.signals.length > 1 ? removeBit(driver, at) : driver))
                    : undefined
                }
              />
            )}
          </Box>
          <BitDetail
            bit={bit}
            chip={held === undefined || shown === null ? undefined : (held.bits[shown] ?? null)}
            edit={
              bit && owner?.driver === CUSTOM
                ? {
                    first: place === 0,
                    last: place === owner.signals.length - 1,
                    full: bits.length >= BITS_MAX,
                    only: owner.signals.length === 1,
                    onSignal: (signal) => edit(bit.motor, (driver) => setSignal(driver, place, signal)),
                    onMove: (by) => {
                      edit(bit.motor, (driver) => moveBit(driver, place, place + by));
                      setSelected(bit.position + by);
                    },
                    onInsert: () => {
                      edit(bit.motor, (driver) => insertBit(driver, place + 1, "Zero"));
                      setSelected(bit.position + 1);
                    },
                    onRemove: () => edit(bit.motor, (driver) => removeBit(driver, place)),
                  }
                : null
            }
            onCustom={bit && owner && owner.driver !== CUSTOM ? () => choose(bit.motor, CUSTOM) : null}
          />
          <p className="mid lines-12 hint m-0 mt-4">
            {KEY.map(([text, looks]) => (
              <span key={text} className="inline gap-4">
                <i className={looks} /> {text}
              </span>
            ))}
          </p>
          <Findings findings={result?.findings ?? []} />
        </Card>

        <Card
          title="In the chip"
          note={
            why ??
            (held === undefined
              ? "reading"
              : different.size === 0
                ? "the same as the design"
                : `${different.size} bits differ from the design`)
          }
          actions={
            sentMatches !== null && (
              <span className={sentMatches ? "good text-12" : "caution text-12"} role="status">
                {sentMatches ? "sent and read back" : "reads back otherwise"}
              </span>
            )
          }
        >
          {chip.isError && connected && (
            <ProblemAlert
              error={chip.error}
              doing={`Reading the chain of ${device?.name}`}
              retry={() => void chip.refetch()}
            />
          )}
          {held ? (
            <>
              <ChainStrip
                label="Chain in the chip"
                bits={held.bits}
                heading={(motor, bits) => (
                  <>
                    <Badge circle variant="default">
                      {motor + 1}
                    </Badge>
                    <span className="num hint push">
                      {bits.at(-1)?.next_motor ? `${bits.length} bits` : "no NxM: never ends"}
                    </span>
                  </>
                )}
                selected={selected}
                onSelect={setSelected}
                onHover={setHovered}
                different={different}
              />
              <Findings findings={held.findings} />
            </>
          ) : (
            <Box mih={STRIP} />
          )}
        </Card>

        {device !== undefined && <Composer device={device} />}
        {device !== undefined && can(device, "driver_chain") && (
          <ChipSelects device={device} lengths={motors.map((bits) => bits.length)} />
        )}

        <div className="columns until-62">
          <Frequencies
            design={result}
            stale={stale}
            clk2Div={clk2Div}
            onClk2Div={setClk2Div}
            rampDivs={rampDivs}
            onRampDivs={setRampDivs}
            chipClk2Div={connected ? chipClk2Div : null}
            device={connected ? id : null}
          />
          <Card
            title="Datagrams"
            note={result ? `${result.datagrams.length} writes to the RAM` : ""}
            actions={
              <CopyButton value={(result?.datagrams ?? []).join("\n")} timeout={1500}>
                {({ copied, copy }) => (
                  <Button
                    size="compact-xs"
                    variant="default"
                    leftSection={<IconCopy size={13} aria-hidden />}
                    disabled={!result}
                    onClick={copy}
                  >
                    <span aria-live="polite">{copied ? "Copied" : "Copy"}</span>
                  </Button>
                )}
              </CopyButton>
            }
          >
            <ol className={`num ${classes.datagrams} list text-12 ${stale ? "stale" : ""}`}>
              {(result?.datagrams ?? []).map((word, index) => (
                <li key={word} data-shown={(shown !== null && Math.floor(shown / 2) === index) || undefined}>
                  {word}
                </li>
              ))}
            </ol>
          </Card>
        </div>
      </div>
    </Page>
  );
}

const KEY = [
  ["coil A", "swatch hue-blue"],
  ["coil B", "swatch hue-orange"],
  ["constant", "swatch hue-grey"],
  ["step, direction", "swatch hue-green"],
  ["unused code", "swatch hue-violet"],
  ["differs from the chip", "dot dot-on"],
] as const;

function Findings({ findings }: { findings: readonly string[] }) {
  if (findings.length === 0) return null;
  return (
    <ul className="list mt-4">
      {findings.map((finding) => (
        <li key={finding} className="caution">
          {finding}
        </li>
      ))}
    </ul>
  );
}

/** The driver chain: what is sent to the drivers, bit by bit, and how often. */
export default function ChainPage() {
  const devices = useDevices();
  const { device } = useSelection();
  if (devices.isPending) return null;
  if (device?.model === "tmc4210") {
    return (
      <Page name="Driver chain">
        <StepDir key={device.id} device={device} />
      </Page>
    );
  }
  return <Editor key={device?.id ?? "-"} device={device} />;
}
