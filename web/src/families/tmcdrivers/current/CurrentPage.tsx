import { Button, Text } from "@mantine/core";
import { IconBolt } from "@tabler/icons-react";
import { useState } from "react";
import { Link } from "wouter";
import { api, type Schemas } from "../../../api/client";
import type { Device } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { duration, fixed, frequency } from "../../../lib/format";
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
import { useLocalKept } from "../../../lib/useKept";
import { WarningLines } from "../../../lib/Warnings";
import { useSelectedAxis } from "../../../live/selection";

type Result = Schemas["ScaleCurrentResult"];
type Asked = Schemas["ScaleCurrent"];

const GROUPS = ["general", "current", "driver", "microsteps"] as const;
/** of the makers' evaluation board */
const BOARD_OHM = 0.1;
const ORDER: ("label" | "input" | "description" | "error")[] = ["label", "input", "description", "error"];
const CHOPPER = ["toff", "tbl", "hstrt", "hend", "HDEC", "rndtf", "chm"] as const;

/** The current of a driver with one scale, and how its chopper regulates it. */
export default function CurrentPage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  if (waiting) return <Waiting page="Current and chopper" />;
  if (!device || !entry)
    return (
      <NoDevice page="Current and chopper" icon={<IconBolt size={22} />} wanted="a driver with one current scale" />
    );
  return <OfDriver key={key} device={device} axis={entry} />;
}

function OfDriver({ device, axis }: { device: Device; axis: Device["axes"][number] }) {
  const chip = useChipRows(device, axis.index, GROUPS);
  const of = `${device.id}.${axis.index}`;
  const known = axis.limits.sense_resistor_ohm ?? null;
  const [kept, setOhm] = useLocalKept(`stepscope.current.sensing.${of}`, BOARD_OHM);
  const ohm = known ?? kept;
  const value = (register: string, field: string) => chip.planned(register, field) ?? 0;
  const asked: Asked = {
    model: device.model as Asked["model"],
    clock_hz: device.clock_hz ?? 15e6,
    sense_resistor_ohm: ohm,
    scale: value("SGCSCONF", "CS"),
    vsense: value("DRVCONF", "vsense"),
    toff: value("CHOPCONF", "toff"),
    tbl: value("CHOPCONF", "tbl"),
  };
  const found = useCalc<Asked, Result>("scale-current", chip.known ? asked : null, ask);
  return (
    <Page name="Current and chopper">
      <DeviceNotice device={device} />
      <ChipNotices chip={chip} device={device} />
      <div className="columns until-62">
        <Card
          title="Motor current"
          note={
            found.result && (
              <span className={found.stale ? "stale" : undefined} data-testid="rms">
                <b className="num">{fixed(found.result.rms_a, 3)}</b> A rms,{" "}
                <span className="num">{fixed(found.result.peak_a, 3)}</span> A peak
              </span>
            )
          }
        >
          <div className="halves gap-8">
            <ChipField
              chip={chip}
              register="SGCSCONF"
              field="CS"
              disabled={!chip.known}
              physical={(scale) => `${scale + 1}/32 of full scale`}
            />
            <ChipField chip={chip} register="DRVCONF" field="vsense" disabled={!chip.known} />
            <NumberField
              label="sense resistor"
              unit="mΩ"
              value={ohm * 1000}
              min={1}
              max={10_000}
              step={5}
              disabled={known !== null}
              description={known === null ? "on the board" : "of the axis, as under Connections"}
              inputWrapperOrder={ORDER}
              onChange={(mOhm) => setOhm(mOhm / 1000)}
            />
            <ChipField
              chip={chip}
              register="DRVCONF"
              field="SDOFF"
              label="what the coils follow"
              disabled={!chip.known}
            />
          </div>
          <Text className="hint" mt={8} mih="3em">
            {found.result &&
              `Full scale is ${fixed(found.result.full_scale_rms_a, 3, "A")} rms; a sense resistor gets ${fixed(
                found.result.sense_power_w * 1000,
              )} mW at most.`}
          </Text>
          <Text className="hint">
            It has no current of its own for standstill: CoolStep lowers it by the load (page{" "}
            <Link href="/stallguard" className="accent">
              StallGuard
            </Link>
            ), and a controller that it is behind scales it at rest.
          </Text>
          <Wanted chip={chip} asked={asked} />
        </Card>
        <Card title="Chopper" note={found.result ? chopperText(found.result) : undefined}>
          <div className="halves gap-8">
            {CHOPPER.map((field) => (
              <ChipField key={field} chip={chip} register="CHOPCONF" field={field} disabled={!chip.known} />
            ))}
          </div>
          <WarningLines texts={chip.known ? (found.result?.warnings ?? []) : []} />
          {found.error !== null && (
            <ProblemAlert error={found.error} doing="Working out the current" retry={found.retry} />
          )}
        </Card>
      </div>
      <StagedDrawer chip={chip} device={device} />
    </Page>
  );
}

function ask(body: Asked, signal: AbortSignal) {
  return api.POST("/api/v1/calc/scale-current", { body, signal });
}

function chopperText({ off_s, blank_s, chopper_max_hz }: Result): string {
  if (off_s === null || chopper_max_hz === null) return "the bridges are off";
  return `slow decay ${duration(off_s)}, blank ${duration(blank_s)}, at most ${frequency(chopper_max_hz)}`;
}

/** The other way: a current that is wanted, and the scale that comes nearest. */
function Wanted({ chip, asked }: { chip: ChipRows; asked: Asked }) {
  const [wanted, setWanted] = useState(1);
  const found = useCalc<Asked, Result>(
    "scale-current-wanted",
    chip.known ? { ...asked, wanted_rms_a: wanted } : null,
    ask,
  );
  const best = found.result?.nearest[0];
  const held = best !== undefined && best.scale === asked.scale && best.vsense === asked.vsense;
  return (
    <div className="flex start gap-8 mt-8">
      <NumberField
        label="Wanted"
        unit="A rms"
        value={wanted}
        min={0.01}
        max={100}
        step={0.05}
        onChange={setWanted}
        inputWrapperOrder={ORDER}
        description={best ? `CS ${best.scale}, vsense ${best.vsense}: ${fixed(best.rms_a, 3, "A")}` : "\u00a0"}
      />
      <Button
        mt={24}
        disabled={!chip.known || best === undefined || found.stale || held}
        title="Stages these values; Apply below writes them"
        onClick={() => {
          if (!best) return;
          chip.put("SGCSCONF", "CS", best.scale);
          chip.put("DRVCONF", "vsense", best.vsense);
        }}
      >
        {held ? "is set" : "Use"}
      </Button>
    </div>
  );
}
