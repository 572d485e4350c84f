import { Text } from "@mantine/core";
import { IconTargetArrow } from "@tabler/icons-react";
import type { Device } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { fixed, rounded } from "../../../lib/format";
import { NoDevice, Waiting } from "../../../lib/NoDevice";
import { Page } from "../../../lib/Page";
import { colorOf, type Quantity } from "../../../lib/palette";
import { ChipNotices } from "../../../lib/rows/ChipNotices";
import { DeviceNotice } from "../../../lib/rows/DeviceNotice";
import { StagedDrawer } from "../../../lib/rows/StagedDrawer";
import { type ChipRows, useChipRows } from "../../../lib/rows/useChipRows";
import { useScheme } from "../../../lib/useScheme";
import { useSelectedAxis } from "../../../live/selection";
import { useTelemetry } from "../../../live/useTelemetry";
import { LiveNumber } from "../../../pages/module/LiveNumber";
import { degrees } from "./angle";
import { Calibration } from "./Calibration";
import classes from "./closedloop.module.css";
import { EncoderSetup } from "./EncoderSetup";
import { LoadDial } from "./LoadDial";
import { LoopPlots } from "./LoopPlots";
import { MODES, Regulation } from "./Regulation";
import { Responses } from "./Responses";
import { useCalibration } from "./useProcedures";

const GROUPS = ["general", "encoder", "closed loop", "pid", "current", "driver"] as const;
const QUANTITIES: readonly Quantity[] = [
  "target_position",
  "position",
  "velocity",
  "encoder_position",
  "encoder_velocity",
  "deviation",
  "load_angle",
  "current_scale",
];
const RATE_HZ = 250;
const KEEP_S = 60;

const NOTHING = { icon: <IconTargetArrow size={22} />, wanted: "a TMC4361" };

/** The loop over encoder and motor: what it does, what it is set to, and how well it does with that. */
export default function ClosedLoopPage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  if (waiting) return <Waiting page="Closed loop" />;
  if (!device || !entry) return <NoDevice page="Closed loop" {...NOTHING} />;
  if (channelsOf(device, entry.index).length === 0)
    return (
      <Page name="Closed loop">
        <DeviceNotice device={device} />
        <NoDevice {...NOTHING} title={`Nothing is known of ${device.name} yet`} />
      </Page>
    );
  return <ClosedLoop key={key} device={device} axis={entry} />;
}

function channelsOf(device: Device, axis: number): string[] {
  return QUANTITIES.map((quantity) => `${quantity}.${axis}`).filter((name) =>
    device.channels.some((channel) => channel.name === name),
  );
}

interface Props {
  device: Device;
  axis: Device["axes"][number];
}

function ClosedLoop({ device, axis }: Props) {
  const scheme = useScheme();
  const at = { device: device.id, axis: axis.index };
  const connected = device.state === "connected";
  const clockHz = device.clock_hz ?? 16e6;
  const rateHz = Math.min(RATE_HZ, device.rate_max_hz);
  const { source, link, buffer } = useTelemetry(device.id, channelsOf(device, axis.index), rateHz, KEEP_S);
  const chip = useChipRows(device, axis.index, GROUPS);
  const calibration = useCalibration(at, connected);
  const last = (quantity: Quantity) => (connected ? buffer.last(`${quantity}.${axis.index}`) : Number.NaN);
  const microsteps = axis.microsteps_per_full_step ?? 256;
  const beta = chip.held("CL_ANGLES", "CL_BETA");
  const mode = chip.held("ENC_IN_CONF", "regulation_modus");
  const constant = chip.held("ENC_CONST");
  const failAt = chip.held("ENC_POS_DEV_TOL");
  return (
    <Page name="Closed loop">
      <DeviceNotice device={device} />
      <ChipNotices chip={chip} device={device} />
      <Card className="pad lines-16 fades" aria-label="Now" data-stale={!connected || link.phase !== "live"}>
        {(
          [
            ["target_position", "Target", "µsteps", 0],
            ["position", "Commanded", "µsteps", 0],
            ["encoder_position", "Encoder", "µsteps", 0],
            ["deviation", "Deviation", "µsteps", 0],
            ["encoder_velocity", "Encoder speed", "pps", 0],
          ] as const
        ).map(([quantity, label, unit, decimals]) => (
          <LiveNumber
            key={quantity}
            label={label}
            unit={unit}
            color={colorOf(quantity, scheme)}
            read={() => fixed(last(quantity), decimals)}
            testId={quantity}
          />
        ))}
        <LiveNumber
          label="Current scale"
          unit="of 255"
          color={colorOf("current_scale", scheme)}
          read={() => fixed(last("current_scale"))}
          testId="current_scale"
        />
        <div>
          <Text size="xs" c="dimmed">
            Regulation
          </Text>
          <span className={`text-16 bold ${mode !== null && mode > 0 ? "accent" : ""}`} data-testid="mode">
            {mode === null ? "–" : (MODES[mode] ?? mode)}
          </span>
        </div>
      </Card>
      <div className="columns side-left until-62">
        <div className="column controls">
          <Regulation
            chip={chip}
            clockHz={clockHz}
            disabled={!chip.known}
            microstepsPerFullStep={axis.microsteps_per_full_step}
          />
          <EncoderSetup chip={chip} microstepsPerTurn={microsteps * axis.full_steps_per_rev} disabled={!chip.known} />
        </div>
        <div className="column">
          <div className={`${classes.top} columns until-75`}>
            <LoopPlots
              source={source}
              link={link}
              name={device.name}
              axis={axis.index}
              tolerance={mode === 1 ? chip.held("CL_TOLERANCE") : null}
              // the power-on value is beyond every deviation: no limit
              failAt={failAt === 2 ** 31 - 1 ? null : failAt}
              betaDeg={mode === 1 && beta !== null ? degrees(beta) : null}
            />
            <div className={`${classes.narrow} column`}>
              <Card title="Load angle" note="electrical">
                <LoadDial
                  read={() => last("load_angle")}
                  beta={beta}
                  gamma={chip.held("CL_ANGLES", "CL_GAMMA")}
                  regulated={mode === 1}
                  emf={chip.held("ENC_IN_CONF", "cl_emf_en") === 1}
                />
              </Card>
              <Calibration
                at={at}
                fullStepsPerRev={axis.full_steps_per_rev}
                calibration={calibration}
                disabled={!connected}
                why={constant === 0 ? "Set the encoder's resolution first: without it ENC_POS does not count." : null}
              />
            </div>
          </div>
          <Responses
            at={at}
            connected={connected}
            emulated={device.emulated}
            rateMaxHz={device.rate_max_hz}
            settings={settingsOf(chip)}
          />
        </div>
      </div>
      <StagedDrawer chip={chip} device={device} />
    </Page>
  );
}

/** The gains that decide a response, in short: what tells one run from the next. */
function settingsOf(chip: ChipRows): string {
  const mode = chip.held("ENC_IN_CONF", "regulation_modus");
  const said = (name: string, value: number | null, show = (each: number) => String(each)) =>
    value === null ? "" : `${name} ${show(value)}`;
  if (mode === null) return "";
  if (mode === 0) return "off";
  if (mode === 1)
    return [
      said("β", chip.held("CL_ANGLES", "CL_BETA")),
      said("P", chip.held("CL_DELTA_P"), (value) => String(rounded(value / 65_536, 3))),
      said("tol", chip.held("CL_TOLERANCE")),
    ]
      .filter(Boolean)
      .join(" · ");
  return [
    mode === 2 ? "PID" : "PID+V",
    said("P", chip.held("PID_P")),
    said("I", chip.held("PID_I")),
    said("D", chip.held("PID_D")),
  ]
    .filter(Boolean)
    .join(" · ");
}
