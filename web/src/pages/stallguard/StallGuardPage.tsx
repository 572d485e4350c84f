import { Anchor } from "@mantine/core";
import { IconGauge } from "@tabler/icons-react";
import { Link } from "wouter";
import { can, type Device } from "../../api/queries";
import { NoDevice, Waiting } from "../../lib/NoDevice";
import { Page } from "../../lib/Page";
import { ChipNotices } from "../../lib/rows/ChipNotices";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { StagedDrawer } from "../../lib/rows/StagedDrawer";
import { useChipRows } from "../../lib/rows/useChipRows";
import { useSelectedAxis } from "../../live/selection";
import { useParameters } from "../module/useParameters";
import { ChipThresholds } from "./ChipThresholds";
import { chipCurrent, chipSettings, passedFrom, placeOf } from "./chip";
import { LoadView } from "./LoadView";
import { AP, NAMES } from "./names";
import { Thresholds } from "./Thresholds";
import { moduleCurrent } from "./thresholds";

const NOTHING = { icon: <IconGauge size={22} />, wanted: "a device that measures the load of its motor" };

/** How hard the motor works: load value, current, and where their thresholds lie. */
export default function StallGuardPage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  if (waiting) return <Waiting page="StallGuard" />;
  if (!device || !entry) return <NoDevice page="StallGuard" {...NOTHING} />;
  if (!device.channels.some((channel) => channel.name === `load_value.${entry.index}`))
    return (
      <Page name="StallGuard">
        <DeviceNotice device={device} />
        <NoDevice {...NOTHING} title={`No load values of ${device.name} yet`} />
      </Page>
    );
  const Load = can(device, "parameters") ? ModuleLoad : ChipLoad;
  return <Load key={key} device={device} axis={entry} />;
}

interface Props {
  device: Device;
  axis: Device["axes"][number];
}

function ModuleLoad({ device, axis }: Props) {
  const connected = device.state === "connected";
  const parameters = useParameters({ device: device.id, axis: axis.index }, NAMES, connected);
  const { held, planned } = parameters;
  const inPps = held(AP.unitMode) === 1;
  return (
    <LoadView
      device={device}
      axis={axis}
      settings={parameters}
      current={moduleCurrent({ run: planned(AP.runCurrent), scaler: planned(AP.scaler) })}
      limits={
        inPps
          ? {
              stealth: held(AP.stealthBelow),
              stealthOn: (held(AP.stealthGradient) ?? 0) > 0,
              coolOn: held(AP.coolOn),
              coolOff: held(AP.coolOff),
              coolStepOn: (held(AP.coolStart) ?? 0) > 0,
            }
          : null
      }
      zones={{
        stealthchop: "StealthChop",
        spreadcycle: "SpreadCycle",
        coolstep: "CoolStep",
        "high speed": "above AP 22",
      }}
      lines={
        planned(AP.unitMode) === 0
          ? null
          : {
              [AP.stealthBelow]: "StealthChop below",
              [AP.coolOn]: "CoolStep above",
              [AP.coolOff]: "CoolStep off above",
              [AP.stopOnStall]: "stops on stall above",
            }
      }
      accelerationPps2={inPps ? held(AP.acceleration) : null}
      thresholds={
        <>
          <ByStudy device={device} />
          <Thresholds parameters={parameters} disabled={!connected} />
        </>
      }
    />
  );
}

/** The way to the study that finds the threshold. */
function ByStudy({ device }: Pick<Props, "device">) {
  return (
    can(device, "encoder") && (
      <Anchor component={Link} href="/tune?kind=stallguard" size="xs" ml={12}>
        Find the threshold by itself
      </Anchor>
    )
  );
}

const GROUPS = ["general", "current", "thresholds", "switches", "driver", "ramp"] as const;

function ChipLoad({ device, axis }: Props) {
  const clockHz = device.clock_hz ?? 16e6;
  const chip = useChipRows(device, axis.index, GROUPS);
  const settings = chipSettings(chip, { clockHz, microstepsPerFullStep: axis.microsteps_per_full_step ?? 256 });
  const current = chipCurrent(settings);
  const { held } = settings;
  const amax = chip.held("AMAX");
  const stealth = held(AP.stealthGradient) === 1;
  return (
    <LoadView
      device={device}
      axis={axis}
      settings={settings}
      current={current}
      limits={{
        stealth: passedFrom(chip, settings, AP.stealthBelow),
        stealthOn: stealth,
        coolOn: passedFrom(chip, settings, AP.coolOn),
        coolOff: passedFrom(chip, settings, AP.coolOff),
        coolStepOn: (held(AP.coolStart) ?? 0) > 0,
      }}
      zones={{
        stealthchop: "StealthChop",
        spreadcycle: "SpreadCycle",
        coolstep: "CoolStep",
        "high speed": `above ${placeOf(chip, AP.coolOff)?.register ?? "the limit"}`,
      }}
      lines={{
        ...(stealth ? { [AP.stealthBelow]: "StealthChop below" } : {}),
        [AP.coolOn]: "works above",
        [AP.coolOff]: "CoolStep off above",
      }}
      accelerationPps2={amax ? (amax * clockHz ** 2) / 2 ** 41 : null}
      thresholds={
        <>
          <ByStudy device={device} />
          <ChipThresholds chip={chip} settings={settings} current={current} disabled={!chip.known} />
        </>
      }
      notice={<ChipNotices chip={chip} device={device} />}
      foot={<StagedDrawer chip={chip} device={device} />}
    />
  );
}
