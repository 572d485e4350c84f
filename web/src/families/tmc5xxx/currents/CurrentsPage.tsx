import { Select, Text } from "@mantine/core";
import { useLocalStorage } from "@mantine/hooks";
import { can, type Device, useCatalogModel } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { Waiting } from "../../../lib/NoDevice";
import { NumberField } from "../../../lib/NumberField";
import { Page } from "../../../lib/Page";
import { ChipNotices } from "../../../lib/rows/ChipNotices";
import { DeviceNotice } from "../../../lib/rows/DeviceNotice";
import { asDriver } from "../../../lib/rows/driver";
import { StagedDrawer } from "../../../lib/rows/StagedDrawer";
import { useChipRows } from "../../../lib/rows/useChipRows";
import { useCalc } from "../../../lib/useCalc";
import { useSelectedAxis } from "../../../live/selection";
import { useTelemetry } from "../../../live/useTelemetry";
import { Chopper } from "./Chopper";
import { askCurrent, CurrentSection } from "./CurrentSection";
import { type Registers, usePaperChip } from "./chip";
import { Follows } from "./Follows";
import { speedLimits } from "./figures";
import { MODELS, type Model, modelOf } from "./models";
import { bodyOf, useSensing } from "./sensing";
import type { SpeedScale } from "./speed";
import { Thresholds } from "./Thresholds";
import { useChopper } from "./useChopper";

/** of chips, and of modules, which keep the same in parameters */
const GROUPS = ["general", "current", "thresholds", "driver", "stealthchop", "chopper", "coolstep", "motor"] as const;
const DEFAULT_CLOCK = 16e6;
const RATE_HZ = 20;

/** What the coils get, at which speed the driver does what, and how its chopper is best set. */
export default function CurrentsPage() {
  const { waiting, device, entry, key } = useSelectedAxis();
  const module = can(device, "parameters");
  const catalog = useCatalogModel(module ? device?.model : undefined);
  if (waiting || (module && catalog.isPending)) return <Waiting page="Currents" />;
  const model = can(device, "chopper") ? modelOf(module ? catalog.data?.driver : device?.model) : null;
  if (device === undefined || entry === undefined || model === null) return <OnPaper />;
  return <OfChip key={key} device={device} axis={entry} model={model} />;
}

function OfChip({ device, axis, model }: { device: Device; axis: Device["axes"][number]; model: Model }) {
  const chip = useChipRows(device, axis.index, GROUPS);
  const channel = `velocity.${axis.index}`;
  const { buffer, link } = useTelemetry(device.id, [channel], Math.min(RATE_HZ, device.rate_max_hz), 2);
  const scale = {
    clockHz: device.clock_hz ?? DEFAULT_CLOCK,
    microsteps: axis.microsteps_per_full_step ?? 256,
    fullStepsPerTurn: axis.full_steps_per_rev,
  };
  const module = can(device, "parameters");
  return (
    <Page name="Currents">
      <DeviceNotice device={device} />
      {module && (
        <Text className="hint">
          Shown as registers of the driver chip in {device.name}, {model.toUpperCase()}; what is staged goes to the
          parameters that set them.
        </Text>
      )}
      <ChipNotices chip={chip} device={device} />
      <Parts
        chip={module ? asDriver(chip, { ...scale, inPps: chip.held("unit_mode") !== 0 }) : chip}
        known={chip.known}
        model={model}
        scale={scale}
        now={() => (link.phase === "live" ? buffer.last(channel) : Number.NaN)}
        of={`${device.id}.${axis.index}`}
      />
      <StagedDrawer chip={chip} device={device} />
    </Page>
  );
}

function OnPaper() {
  const [model, setModel] = useLocalStorage<Model>({ key: "stepscope.currents.model", defaultValue: "tmc5160" });
  const [clockMhz, setClockMhz] = useLocalStorage({ key: "stepscope.currents.clock", defaultValue: 16 });
  const chip = usePaperChip(model, 0);
  return (
    <Page name="Currents">
      <Card
        title="On paper"
        note="no TMC5xxx is selected: what is set here is for the eye alone"
        actions={
          <div className="flex gap-8">
            <Select
              aria-label="Chip"
              w={120}
              data={MODELS.map((each) => ({ value: each, label: each.toUpperCase() }))}
              value={model}
              onChange={(value) => value && setModel(value as Model)}
            />
            <NumberField
              aria-label="Clock fCLK"
              unit="MHz"
              w={110}
              value={clockMhz}
              min={4}
              max={18}
              onChange={setClockMhz}
            />
          </div>
        }
      >
        <Text className="hint">
          Add a TMC5160 under Connections, an emulated one needs no hardware, and these settings go to its registers.
        </Text>
      </Card>
      <Parts
        key={model}
        chip={chip}
        known={chip.spot("IHOLD_IRUN") !== null}
        model={model}
        scale={{ clockHz: clockMhz * 1e6, microsteps: 256, fullStepsPerTurn: 200 }}
        now={() => Number.NaN}
        of={model}
      />
    </Page>
  );
}

interface Parts {
  chip: Registers;
  /** the register list is there */
  known: boolean;
  model: Model;
  scale: SpeedScale;
  now: () => number;
  /** what the resistors are kept for: a device's axis, or a model on paper */
  of: string;
}

function Parts({ chip, known, model, scale, now, of }: Parts) {
  const [sensing, onSensing] = useSensing(model, of);
  const run = useCalc("coil-current", bodyOf(chip, model, scale.clockHz, sensing), askCurrent);
  const chopper = useChopper(chip, model, scale, run.result?.run.rms_a ?? null);
  const follows = chopper.answer.result;
  return (
    <div className="columns until-62">
      <div className="whole">
        <Thresholds
          chip={chip}
          scale={scale}
          limits={follows ? speedLimits(follows.figures) : []}
          now={now}
          disabled={!known}
        />
      </div>
      <div className="column ahead">
        <CurrentSection
          chip={chip}
          model={model}
          clockHz={scale.clockHz}
          sensing={sensing}
          onSensing={onSensing}
          disabled={!known}
        />
        {follows && <Follows result={follows} stale={chopper.answer.stale} />}
      </div>
      <Chopper chip={chip} chopper={chopper} disabled={!known} />
    </div>
  );
}
