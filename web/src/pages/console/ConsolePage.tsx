import { IconTerminal2 } from "@tabler/icons-react";
import { can, type Device, useCatalogModel, useDevices } from "../../api/queries";
import { Card } from "../../lib/Card";
import { NoDevice } from "../../lib/NoDevice";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { useSelection } from "../../live/selection";
import { ExchangeConsole } from "../registers/ExchangeConsole";
import css from "./console.module.css";
import { DirectMode } from "./DirectMode";
import { FrameLog } from "./FrameLog";
import { WirePanel } from "./WirePanel";

/** Commands as they are, and everything that goes over the wire. */
export default function ConsolePage() {
  const devices = useDevices();
  const { device } = useSelection();
  if (devices.isError && !device)
    return (
      <Page name="Console">
        <ProblemAlert error={devices.error} doing="Looking for devices" retry={() => void devices.refetch()} />
      </Page>
    );
  if (!device)
    return (
      <div className="stack gap-8 text-13">
        <h1 className="flex baseline gap-8 m-0 text-16">Console</h1>
        {devices.isSuccess && <NoDevice title="No device to talk to" icon={<IconTerminal2 size={22} />} />}
      </div>
    );
  return (
    <div className="stack gap-8 text-13">
      <h1 className="flex baseline gap-8 m-0 text-16">
        Console<span className="text-13 regular dim">{`${device.name} · ${device.title}`}</span>
      </h1>
      <DeviceNotice device={device} />
      <div className={`${css.columns} columns until-75`}>
        <div className="grid shrink gap-8">
          <Commands key={device.id} device={device} />
        </div>
        <div className="grid shrink gap-8">
          <WirePanel device={device} />
          <FrameLog key={device.id} device={device} />
        </div>
      </div>
    </div>
  );
}

/** What a device is told word by word: commands to a module, datagrams to a chip. */
export function Commands({ device }: { device: Device }) {
  return can(device, "parameters") ? <DirectMode device={device} /> : <Datagrams device={device} />;
}

function Datagrams({ device }: { device: Device }) {
  const catalog = useCatalogModel(device.model);
  return (
    <Card title="Raw datagrams" note="one out, one back">
      <ExchangeConsole
        device={device}
        connected={device.state === "connected"}
        rows={catalog.data?.rows ?? []}
        selected={null}
        raw={null}
      />
    </Card>
  );
}
