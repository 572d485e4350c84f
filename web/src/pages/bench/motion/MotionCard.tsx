import { Group, Stack, Tabs, Text } from "@mantine/core";
import { Link } from "wouter";
import { can, type Device } from "../../../api/queries";
import { useAddressChoice } from "../../../lib/address";
import { Card } from "../../../lib/Card";
import { Choice } from "../../../lib/Choice";
import { ConditionCard } from "../../../lib/condition/ConditionCard";
import { useAxisReading } from "../../../lib/condition/useAxisReading";
import { fixed } from "../../../lib/format";
import { later } from "../../../lib/later";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { fromSteps, ratesOf, scaleOf, symbolOf, unitsFor } from "../../../lib/units";
import { LiveText } from "../../../live/LiveText";
import classes from "../bench.module.css";
import { Lamps } from "../Lamps";
import { useLiveAxis } from "../live";
import { JogSection } from "./JogSection";
import { MoveSection } from "./MoveSection";
import { ShuttleSection } from "./ShuttleSection";
import { useAction } from "./useAction";
import { useTopSpeed } from "./useMotionLimits";

const ModuleSearch = later(() =>
  import("../../../families/tmcl/search/ModuleSearch").then((part) => part.ModuleSearch),
);
const StallSection = later(() => import("./StallSection").then((part) => part.StallSection));
const ReferenceSection = later(() => import("./ReferenceSection").then((part) => part.ReferenceSection));
const TogetherSection = later(() => import("./TogetherSection").then((part) => part.TogetherSection));

interface Props {
  device: Device;
  axis: Device["axes"][number];
  unit: string;
  onUnit: (unit: string) => void;
}

/** The selected axis: where it is, and everything that moves it. */
export function MotionCard({ device, axis, unit, onUnit }: Props) {
  const at = { device: device.id, axis: axis.index };
  const connected = device.state === "connected";
  const live = useLiveAxis(device.id, axis.index);
  const scale = scaleOf(axis, device.clock_hz);
  const units = unitsFor("position", scale);
  const shown = units.includes(unit) ? unit : "microsteps";
  const rate = ratesOf(shown, scale).velocity;
  const decimals = shown === "microsteps" ? 0 : 3;
  const topSpeed = useTopSpeed(at, device, scale, connected);
  const [tab, setTab] = useAddressChoice("tab", ["shuttle", "together", "reference", "stall"]);
  const action = useAction();
  const state = useAxisReading(device.id, axis.index, connected);
  const disabled = !connected;
  const stepped = can(device, "step_input");
  const stalls = can(device, "stallguard") || (can(device, "stallguard.behind") && device.drivers.length > 0);
  const common = { at, scale, unit: shown, action, disabled };
  return (
    <Card className={`${classes.card} stack gap-8`} aria-label={`Motion of ${axis.name}`} data-testid="motion-card">
      <Group justify="space-between" wrap="nowrap">
        <h2 className="m-0 clip text-14 bold">
          {device.name} · {axis.name}
        </h2>
        <span className="tag nowrap" title="Mode" data-testid="mode">
          {connected ? (state.data?.mode ?? "…") : device.state}
        </span>
      </Group>
      <div className={`${classes.readout} row between gap-8`} data-stale={!connected}>
        <LiveText
          className={`figure-20 text-28 grow right nowrap`}
          read={() => fixed(fromSteps(live.read("position"), shown, scale, "position"), decimals)}
          data-testid="position"
        />
        <Choice
          aria-label="Unit"
          w={92}
          data={units.map((each) => ({ value: each, label: symbolOf(each) }))}
          value={shown}
          onChange={(value) => onUnit(value)}
        />
      </div>
      <Group justify="space-between" wrap="nowrap" className="text-12">
        <span>
          <LiveText
            className={`${classes.speed} inline-block mono right`}
            read={() =>
              fixed(fromSteps(live.read("velocity"), rate, scale, "velocity"), shown === "microsteps" ? 0 : 2)
            }
          />{" "}
          <Text span size="xs" c="dimmed">
            {symbolOf(rate)}
          </Text>
        </span>
        <Lamps live={live} device={device} />
      </Group>
      <ConditionCard
        key={`condition ${device.id}/${axis.index}`}
        device={device}
        axis={axis}
        nowS={state.data?.time_s}
      />
      <Stack gap={8}>
        {!stepped && <MoveSection key={`${device.id}/${axis.index}`} {...common} />}
        {stepped && (
          <Text size="xs" c="dimmed">
            It counts no position, and follows the steps that it is given.
            {can(device, "own_velocity") && " A velocity of its own jumps: it has no ramp."}
          </Text>
        )}
        {(!stepped || can(device, "own_velocity")) && (
          <JogSection key={`jog ${device.id}/${axis.index}`} {...common} topSpeedPps={topSpeed} />
        )}
      </Stack>
      <div className={`${classes.cardMore} stack gap-8`}>
        {device.problem && <ProblemAlert error={device.problem} doing={device.name} />}
        {!connected && (
          <Text size="xs">
            Not connected: see <Link href="/connections">Connections</Link>.
          </Text>
        )}
        {action.failure && (
          <ProblemAlert error={action.failure.error} doing={action.failure.doing} onClose={action.dismiss} />
        )}
        {action.notes.map((note) => (
          <Text key={note} size="xs" c="dimmed" role="status">
            {note}
          </Text>
        ))}
        {!stepped && (
          <Tabs
            value={tab === "stall" && !stalls ? "shuttle" : tab}
            onChange={(next) => setTab(next as typeof tab)}
            keepMounted={false}
            classNames={{ tab: "pad-s text-12", panel: `pt-8 stack gap-8` }}
          >
            <Tabs.List grow>
              <Tabs.Tab value="shuttle">Shuttle</Tabs.Tab>
              <Tabs.Tab value="together">Together</Tabs.Tab>
              <Tabs.Tab value="reference">Zero</Tabs.Tab>
              {stalls && <Tabs.Tab value="stall">Stall</Tabs.Tab>}
            </Tabs.List>
            <Tabs.Panel value="shuttle">
              <ShuttleSection key={`${device.id}/${axis.index}`} {...common} live={live} />
            </Tabs.Panel>
            <Tabs.Panel value="together">
              <TogetherSection key={device.id} device={device} unit={shown} action={action} disabled={disabled} />
            </Tabs.Panel>
            <Tabs.Panel value="reference">
              {can(device, "parameters") && can(device, "home_switch") ? (
                <ModuleSearch
                  key={`${device.id}/${axis.index}`}
                  at={at}
                  device={device}
                  action={action}
                  disabled={disabled}
                />
              ) : (
                <ReferenceSection
                  key={`${device.id}/${axis.index}`}
                  at={at}
                  device={device}
                  action={action}
                  disabled={disabled}
                />
              )}
            </Tabs.Panel>
            {stalls && (
              <Tabs.Panel value="stall">
                <StallSection key={`${device.id}/${axis.index}`} at={at} action={action} disabled={disabled} />
              </Tabs.Panel>
            )}
          </Tabs>
        )}
      </div>
    </Card>
  );
}
