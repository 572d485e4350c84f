import { IconRotateClockwise2 } from "@tabler/icons-react";
import { useQueryClient } from "@tanstack/react-query";
import { api } from "../../api/client";
import { can, type Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { NoDevice, Waiting } from "../../lib/NoDevice";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { ChipField } from "../../lib/rows/ChipField";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { StagedDrawer } from "../../lib/rows/StagedDrawer";
import { useChipRows } from "../../lib/rows/useChipRows";
import { useSelectedAxis } from "../../live/selection";
import { useParameters } from "../module/useParameters";
import { ConstSection } from "./ConstSection";
import { EncoderView } from "./EncoderView";
import { IndexSection } from "./IndexSection";
import { Counter, Limits } from "./Limits";
import { encoderSettings, LIMIT_NAMES } from "./settings";
import { ENCODERS, encodersOf, type Which } from "./useEncoder";

const NOTHING = { icon: <IconRotateClockwise2 size={22} />, wanted: "a device with an encoder" };

/** What the encoder says of the shaft, against what the motor was told. */
export default function EncoderPage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  if (waiting) return <Waiting page="Encoder" />;
  if (!device || !entry) return <NoDevice page="Encoder" {...NOTHING} />;
  const encoders = encodersOf(device, entry.index);
  if (encoders.length === 0)
    return (
      <Page name="Encoder">
        <DeviceNotice device={device} />
        <NoDevice
          {...NOTHING}
          title={
            device.state === "connected" && device.channels.length > 0
              ? `A ${device.title} has no encoder`
              : `No encoder values of ${device.name} yet`
          }
        />
      </Page>
    );
  const Encoder = can(device, "parameters") ? ModuleEncoder : ChipEncoder;
  return <Encoder key={key} device={device} axis={entry} encoders={encoders} />;
}

interface Props {
  device: Device;
  axis: Device["axes"][number];
  encoders: readonly Which[];
}

function ModuleEncoder({ device, axis, encoders }: Props) {
  const connected = device.state === "connected";
  const parameters = useParameters({ device: device.id, axis: axis.index }, LIMIT_NAMES, connected);
  return (
    <EncoderView
      device={device}
      axis={axis}
      encoders={encoders}
      settings={parameters}
      side={({ shown, microstepsPerTurn, counter }) => (
        <>
          <Limits parameters={parameters} shown={shown} microstepsPerTurn={microstepsPerTurn} disabled={!connected} />
          {shown.slice(0, 1).map((which) => (
            <Counter
              key={which}
              {...counter}
              alias={which === "internal" ? "AP 209" : "AP 216"}
              write={(value) => parameters.writeNow(new Map([[ENCODERS[which].position, value]]))}
            />
          ))}
        </>
      )}
    />
  );
}

const GROUPS = ["general", "encoder", "ramp", "switches"] as const;

function ChipEncoder({ device, axis, encoders }: Props) {
  const queries = useQueryClient();
  const connected = device.state === "connected";
  const chip = useChipRows(device, axis.index, GROUPS);
  const settings = encoderSettings(chip, device.clock_hz ?? 16e6);
  async function write(value: number) {
    const path = { device: device.id, name: "X_ENC" };
    await api.PUT("/api/v1/devices/{device}/registers/{name}", { path, query: { axis: axis.index }, body: { value } });
    void queries.invalidateQueries({ queryKey: ["registers", device.id] });
  }
  return (
    <EncoderView
      device={device}
      axis={axis}
      encoders={encoders}
      settings={settings}
      notice={
        connected &&
        chip.live.readings.isError && (
          <ProblemAlert
            error={chip.live.readings.error}
            doing={`Reading ${device.name}`}
            retry={() => void chip.live.readings.refetch()}
          />
        )
      }
      side={({ microstepsPerTurn, counted, counter }) => (
        <>
          <ConstSection
            chip={chip}
            second={axis.index === 1}
            counted={counted}
            microstepsPerTurn={microstepsPerTurn}
            disabled={!chip.known}
          />
          <IndexSection chip={chip} disabled={!chip.known} />
          {chip.spot("ENC_DEVIATION") !== null && (
            <Card title="Deviation warning" note="0 is off">
              <ChipField chip={chip} register="ENC_DEVIATION" disabled={!chip.known} step={10} />
            </Card>
          )}
          <Counter {...counter} alias="X_ENC" write={write} />
        </>
      )}
      stopsUnder="views"
      foot={<StagedDrawer chip={chip} device={device} />}
    />
  );
}
