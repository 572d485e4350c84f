import { Button, Text } from "@mantine/core";
import { IconArrowsJoin } from "@tabler/icons-react";
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
import { useCalc } from "../../../lib/useCalc";
import { WarningList } from "../../../lib/Warnings";
import { useSelectedAxis } from "../../../live/selection";
import { useEmulator } from "../../../pages/bench/useEmulator";
import { dcVelocity, type SyncQuestion, slowestClocks, syncQuestion, TIMES } from "./question";

const GROUPS = ["general", "spi output", "driver", "pwm", "ramp"] as const;
const NOTHING = { icon: <IconArrowsJoin size={22} />, wanted: "a TMC4361" };
const DEFAULT_CLOCK = 16e6;
const WANTED_HZ = 36e3;

/** What the chip and its motor driver do in step with each other: the chopper's clock, and steps that wait. */
export default function DriverSyncPage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  if (waiting) return <Waiting page="Driver sync" />;
  if (!device || !entry) return <NoDevice page="Driver sync" {...NOTHING} />;
  return <DriverSync key={key} device={device} axis={entry} />;
}

function DriverSync({ device, axis }: { device: Device; axis: Device["axes"][number] }) {
  const chip = useChipRows(device, axis.index, GROUPS);
  const [wantedHz, setWantedHz] = useState(WANTED_HZ);
  const clockHz = device.clock_hz ?? DEFAULT_CLOCK;
  const question = syncQuestion(chip, { clockHz, fullStepsPerRev: axis.full_steps_per_rev, wantedHz });
  const found = useCalc<SyncQuestion, Schemas["DriverSyncResult"]>(
    "driver-sync",
    chip.known && question.chopsync_div ? question : null,
    (body, signal) => api.POST("/api/v1/calc/driver-sync", { body, signal }),
  );
  const { result, stale } = found;
  const at = { chip, disabled: !chip.known, clockHz };
  return (
    <Page name="Driver sync">
      <DeviceNotice device={device} />
      <ChipNotices chip={chip} device={device} />
      {found.error !== null && <ProblemAlert error={found.error} doing="Calculating" retry={found.retry} />}
      <div className="columns until-75" data-stale={device.state !== "connected"}>
        <div className="column">
          <Card title="dcStep" note="under load the motor slows down and loses no step">
            <DcStepFields {...at} question={question} />
            <div className={stale ? "stale" : undefined} aria-busy={stale}>
              {result && <DcStepFacts result={result.dcstep} />}
            </div>
            {device.emulated && <Waits device={device} />}
          </Card>
        </div>
        <div className="column">
          <Card title="chopSync" note="the chopper's clock for a TMC23x or TMC24x">
            <ChopSyncFields {...at} />
            <div className="lines-12 end my-8">
              <NumberField
                label="Wanted clock"
                unit="kHz"
                min={1}
                max={1000}
                value={wantedHz / 1e3}
                onChange={(khz) => setWantedHz(khz * 1e3)}
                w={120}
                data-testid="wanted-clock"
              />
              <Button
                variant="default"
                disabled={!result || stale || result.chopsync.nearest_div === question.chopsync_div}
                onClick={() => result && chip.put("CHOPSYNC_DIV", undefined, result.chopsync.nearest_div)}
                data-testid="use-divider"
              >
                {result ? `CHOPSYNC_DIV ${result.chopsync.nearest_div}` : "CHOPSYNC_DIV"}
              </Button>
            </div>
            <div className={stale ? "stale" : undefined} aria-busy={stale}>
              {result && (
                <>
                  <table className="figures" data-testid="chopsync-facts">
                    <tbody>
                      <Row name="Clock of the chopper" value={frequency(result.chopsync.hz)} />
                      <Row name="at standstill" value={frequency(result.chopsync.rest_hz)} />
                    </tbody>
                  </table>
                  <WarningList texts={result.chopsync.warnings} />
                </>
              )}
            </div>
            <Text className="hint mt-4">
              CHOPSYNC_DIV and PWM_FREQ are one register. The emulated driver chops by itself: it has the clock at the
              pin STDBY_CLK, and no effect on the motor.
            </Text>
          </Card>
          <Card title="What the driver has to be set to">
            <ul className="list text-12">
              <li>
                TMC26x, mode 3: chopper with constant off time (CHM 1), slow decay only (HSTRT 0), TST 1, SGT0 and SGT1
                1.
              </li>
              <li>
                TMC2130, mode 2: its DCO at MP1 (STEP_READY), its DCEN at MP2; DCCTRL and VDCMIN in the driver itself.
              </li>
              <li>
                Not known from the documents at hand: how long exactly the ramp waits. The emulated chip makes the next
                full step at 45° of lag.
              </li>
            </ul>
          </Card>
        </div>
      </div>
      <StagedDrawer chip={chip} device={device} />
    </Page>
  );
}

interface FieldsProps {
  chip: ChipRows;
  disabled: boolean;
  clockHz: number;
}

function DcStepFields({ chip, disabled, clockHz, question }: FieldsProps & { question: SyncQuestion }) {
  const at = { chip, disabled };
  const microsteps = question.microsteps ?? 256;
  const turn = question.full_steps_per_rev ?? 200;
  const velocity = chip.planned("DC_VEL");
  const slowest = chip.planned("DC_LSPTM");
  const time = (clocks: number) => duration(clocks / clockHz);
  return (
    <>
      <ChipField {...at} register="GENERAL_CONF" field="dcstep_mode" label="STEP_READY" />
      <div className="halves start gap-8 mt-4">
        <ChipField {...at} register="DC_VEL" label="acts above" step={1000} />
        <NumberField
          label="as a speed"
          unit="rpm"
          min={0}
          max={1e5}
          step={10}
          value={velocity === null ? null : (velocity / microsteps / turn) * 60}
          show={(rpm) => compact(rpm)}
          placeholder="?"
          disabled={disabled}
          onChange={(rpm) => chip.put("DC_VEL", undefined, dcVelocity(rpm, microsteps, turn))}
          data-testid="dc-vel-rpm"
        />
        <ChipField {...at} register="DC_LSPTM" label="longest wait" step={1000} physical={time} />
        <NumberField
          label="so at least"
          unit="full steps/s"
          min={clockHz / (2 ** 32 - 1)}
          max={clockHz}
          step={1}
          value={slowest === null || slowest === 0 ? null : clockHz / slowest}
          show={(rate) => compact(rate)}
          placeholder="?"
          disabled={disabled}
          onChange={(rate) => chip.put("DC_LSPTM", undefined, slowestClocks(rate, clockHz))}
          data-testid="dc-least"
        />
        <ChipField {...at} register={TIMES} field="DC_TIME" label="ready below" physical={time} />
        <ChipField {...at} register={TIMES} field="DC_SG" label="lost below" physical={(value) => time(16 * value)} />
        <ChipField {...at} register={TIMES} field="DC_BLKTIME" label="blank" physical={time} />
        <ChipField {...at} register="SPI_OUT_CONF" field="spi_output_format" />
      </div>
    </>
  );
}

function ChopSyncFields({ chip, disabled, clockHz }: FieldsProps) {
  const at = { chip, disabled };
  return (
    <>
      <div className="halves start gap-8">
        <ChipField
          {...at}
          register="CHOPSYNC_DIV"
          physical={(value) => (value === 0 ? "none" : frequency(clockHz / value))}
        />
        <ChipField {...at} register="GENERAL_CONF" field="stdby_clk_pin_assignment" />
      </div>
      <div className="grid gap-6 my-8">
        <ChipField {...at} register="SPI_OUT_CONF" field="auto_double_chopsync" label="twice at standstill, TMC24x" />
        <ChipField {...at} register="SPI_OUT_CONF" field="pwm_phase_shft_en" label="phases in turn, TMC24x" />
      </div>
    </>
  );
}

function DcStepFacts({ result }: { result: Schemas["DcStepResult"] }) {
  const { full_step_s: step, least_full_steps_per_s: least, least_rpm: slow } = result;
  return (
    <>
      <table className="figures mt-4" data-testid="dcstep-facts">
        <tbody>
          <Row
            name="From"
            value={
              step === null
                ? "never"
                : `${compact(result.full_steps_per_s)} full steps/s, ${compact(result.rpm, 4, "rpm")}`
            }
          />
          <Row name="A full step there takes" value={duration(step)} />
          <Row
            name="Slowed down at most to"
            value={
              least === null || slow === null
                ? "no limit"
                : `${compact(least)} full steps/s, ${compact(slow, 4, "rpm")}`
            }
          />
          <Row name="Ready for on times below" value={duration(result.on_time_s)} />
          <Row name="A step is lost below" value={duration(result.lost_s)} />
          <Row name="Nothing is compared for" value={duration(result.blank_s)} />
        </tbody>
      </table>
      <WarningList texts={result.warnings} />
    </>
  );
}

function Row({ name, value }: { name: string; value: string }) {
  return (
    <tr>
      <th scope="row">{name}</th>
      <td className="num">{value}</td>
    </tr>
  );
}

/** Whether the emulated ramp waits for its motor just now. */
function Waits({ device }: { device: Device }) {
  const emulator = useEmulator(device, true);
  const state = (emulator.data as Schemas["Tmc4361State"] | undefined)?.dcstep;
  if (state === undefined) return null;
  return (
    <Text className="hint mt-4" data-testid="dcstep-now">
      {!state.enabled
        ? "MP2: not enabled at this speed."
        : state.step_ready
          ? "MP2: enabled. MP1: the motor follows."
          : `MP2: enabled. MP1: the ramp has waited for ${fixed(state.waited_s * 1e3, 1, "ms")}.`}
    </Text>
  );
}
