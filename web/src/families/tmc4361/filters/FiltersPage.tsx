import { Button, Loader, SegmentedControl, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { api } from "../../../api/client";
import { can, type Device, useDevices } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { compact, frequency } from "../../../lib/format";
import { Waiting } from "../../../lib/NoDevice";
import { NumberField } from "../../../lib/NumberField";
import { Page } from "../../../lib/Page";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { DeviceNotice } from "../../../lib/rows/DeviceNotice";
import { StagedDrawer } from "../../../lib/rows/StagedDrawer";
import { useChipRows } from "../../../lib/rows/useChipRows";
import { useCalc } from "../../../lib/useCalc";
import { useSelection } from "../../../live/selection";
import classes from "./filters.module.css";
import { GroupCard, type GroupSetting } from "./GroupCard";
import { Waveforms } from "./Waveforms";
import { type Bounds, exampleOf, type Filters, fates, timeText } from "./waves";

const REGISTER_GROUPS = ["filters"] as const;
const DEFAULT_CLOCK = 16e6;

/** The four input filters of a TMC4361: what they do to a waveform, before INPUT_FILT_CONF is written. */
export default function FiltersPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  const filters = useQuery({
    queryKey: ["calc", "input-filters"],
    queryFn: () => api.GET("/api/v1/calc/input-filter"),
    staleTime: Number.POSITIVE_INFINITY,
  });
  if (filters.isError)
    return (
      <Page name="Input filters">
        <ProblemAlert error={filters.error} doing="Asking for the filters" retry={() => void filters.refetch()} />
      </Page>
    );
  if (filters.isPending || (devices.data === undefined && !devices.isError))
    return <Waiting page="Input filters" label="Loading the filters" />;
  const own = can(device, "input_filters") ? device : undefined;
  const known: Device | undefined = own && devices.isError ? { ...own, state: "disconnected" } : own;
  return <FilterDesigner key={`${own?.id ?? "-"}/${axis}`} device={known} axis={axis} filters={filters.data} />;
}

type Choice = "sheet" | "bounce" | "glitches" | "own";

interface Props {
  /** undefined: the page works without a chip */
  device: Device | undefined;
  axis: number;
  filters: Filters;
}

const NOTHING: GroupSetting = { sampleRate: 0, length: 0, stepInput: 0, staged: false, known: true };

function FilterDesigner({ device, axis, filters }: Props) {
  const chip = useChipRows(device, axis, REGISTER_GROUPS);
  const [own, setOwn] = useState<Record<string, GroupSetting>>(() =>
    // without a chip the settings of the data sheet's figures are a start
    Object.fromEntries(
      filters.groups.map(({ suffix }) => {
        const example = filters.examples.find((candidate) => candidate.group === suffix);
        return [suffix, { ...NOTHING, sampleRate: example?.sample_rate ?? 0, length: example?.length ?? 0 }];
      }),
    ),
  );
  const [chosen, setChosen] = useState(filters.groups[1]?.suffix ?? "");
  const [choice, setChoice] = useState<Choice>("bounce");
  const [drawn, setDrawn] = useState<number[] | null>(null);
  const [phase, setPhase] = useState(0);
  const [ownClock, setOwnClock] = useState(DEFAULT_CLOCK);
  const clockHz = device?.clock_hz ?? ownClock;
  const register = filters.register_name;

  const settingOf = (suffix: string): GroupSetting => {
    const group = filters.groups.find((candidate) => candidate.suffix === suffix);
    if (device === undefined || group === undefined) return own[suffix] ?? NOTHING;
    const fields = [group.sample_rate_field, group.length_field, group.step_input_field];
    const [sampleRate, length, stepInput] = fields.map((field) => chip.planned(register, field));
    return {
      sampleRate: sampleRate ?? 0,
      length: length ?? 0,
      stepInput: stepInput ?? 0,
      staged: fields.some((field) => chip.isStaged(register, field)),
      known: sampleRate !== null && sampleRate !== undefined,
    };
  };
  const change = (suffix: string, part: Partial<GroupSetting>) => {
    const group = filters.groups.find((candidate) => candidate.suffix === suffix);
    if (group === undefined) return;
    if (device === undefined) {
      setOwn((now) => ({ ...now, [suffix]: { ...(now[suffix] ?? NOTHING), ...part } }));
      return;
    }
    if (part.sampleRate !== undefined) chip.put(register, group.sample_rate_field, part.sampleRate);
    if (part.length !== undefined) chip.put(register, group.length_field, part.length);
    if (part.stepInput !== undefined) chip.put(register, group.step_input_field, part.stepInput);
  };

  const group = filters.groups.find((candidate) => candidate.suffix === chosen) ?? filters.groups[0];
  const setting = settingOf(chosen);
  const sheet = filters.examples.find((example) => example.group === chosen);
  const shown: Choice = (choice === "sheet" && !sheet) || (choice === "own" && drawn === null) ? "bounce" : choice;
  const input =
    shown === "own" && drawn !== null
      ? drawn
      : shown === "sheet" && sheet
        ? sheet.input
        : exampleOf(shown === "glitches" ? "glitches" : "bounce", setting);
  const period = 2 ** setting.sampleRate;
  const calculation = useCalc(
    "input-filter",
    {
      clock_hz: clockHz,
      sample_rate: setting.sampleRate,
      length: setting.length,
      input,
      phase: Math.min(phase, period - 1),
    },
    (body, signal) => api.POST("/api/v1/calc/input-filter", { body, signal }),
  );
  const result = calculation.result;
  const select = (suffix: string) => {
    setChosen(suffix);
    setPhase(0);
    if (choice === "own") setChoice("bounce");
  };
  const pins = group?.pins ?? [];
  const pin = (shown === "sheet" && sheet?.pin) || pins[0] || "";

  return (
    <Page name="Input filters">
      {device && <DeviceNotice device={device} />}
      {device && chip.live.catalog.isError && (
        <ProblemAlert
          error={chip.live.catalog.error}
          doing="Reading the register list"
          retry={() => void chip.live.catalog.refetch()}
        />
      )}
      <div className="columns side-left until-62" data-stale={device !== undefined && device.state !== "connected"}>
        <div className={`${classes.groups} column`} role="radiogroup" aria-label="Group of pins">
          {filters.groups.map((each) => (
            <GroupCard
              key={each.suffix}
              group={each}
              setting={settingOf(each.suffix)}
              clockHz={clockHz}
              chosen={each.suffix === chosen}
              onChoose={() => select(each.suffix)}
              onChange={(part) => change(each.suffix, part)}
            />
          ))}
          {device === undefined && (
            <NumberField
              label="Clock fCLK"
              unit="MHz"
              value={ownClock / 1e6}
              min={4.2}
              max={32}
              step={1}
              onChange={(mhz) => setOwnClock(mhz * 1e6)}
            />
          )}
        </div>
        <div className="column ahead">
          <Card
            title={`Waveform at ${pin}`}
            note={`${frequency(clockHz)}, a sample every ${period === 1 ? "clock" : `${period} clocks`}`}
            actions={
              <SegmentedControl
                aria-label="Example"
                data={[
                  { value: "bounce", label: "Bouncing" },
                  { value: "glitches", label: "Glitches" },
                  ...(sheet ? [{ value: "sheet", label: `Figure ${sheet.figure}` }] : []),
                  ...(drawn === null ? [] : [{ value: "own", label: "Drawn" }]),
                ]}
                value={shown}
                onChange={(value) => setChoice(value as Choice)}
              />
            }
          >
            {calculation.error !== null && (
              <ProblemAlert error={calculation.error} doing="Filtering" retry={calculation.retry} />
            )}
            <Waveforms
              pin={pin}
              input={input}
              result={result}
              stale={calculation.stale}
              clockHz={clockHz}
              onInput={(levels) => {
                setDrawn(levels);
                setChoice("own");
              }}
            />
            <div className="lines-12 end mt-4">
              <Text size="xs" c="dimmed" className={classes.how}>
                Draw on the upper line: a stroke sets the level. Shaded pulses do not get through; slanted lines lead
                from an edge to when it counts.
              </Text>
              <NumberField
                label="First sample at clock"
                title="The chip does not tell on which clocks it samples: see what each of them does"
                integer
                min={0}
                max={period - 1}
                value={Math.min(phase, period - 1)}
                disabled={period === 1}
                onChange={setPhase}
                w={160}
              />
              {shown === "own" && (
                <Button variant="default" onClick={() => setChoice("bounce")}>
                  Back to the example
                </Button>
              )}
            </div>
            {shown === "sheet" && sheet && (
              <Text size="xs" c="dimmed">
                Figure {sheet.figure} of DS-TMC4361 is about SR = {sheet.sample_rate}, FILT_L = {sheet.length}.{" "}
                {(sheet.sample_rate !== setting.sampleRate || sheet.length !== setting.length) && (
                  <Button
                    size="compact-xs"
                    variant="subtle"
                    onClick={() => change(chosen, { sampleRate: sheet.sample_rate, length: sheet.length })}
                  >
                    Set them here
                  </Button>
                )}
              </Text>
            )}
          </Card>
          <Card title="What this filter does to any edge" note="wherever its samples fall">
            {result ? <BoundsTable bounds={result.bounds} counts={fates(result)} /> : <Loader size="xs" />}
          </Card>
        </div>
      </div>
      {device && <StagedDrawer chip={chip} device={device} />}
    </Page>
  );
}

function BoundsTable({ bounds, counts }: { bounds: Bounds; counts: ReturnType<typeof fates> }) {
  const rows: readonly [string, number, number, string][] = [
    ["Pulses up to this never pass", bounds.stopped_clocks, bounds.stopped_s, "stopped"],
    ["Pulses from this on always pass", bounds.passed_clocks, bounds.passed_s, "always"],
    ["An edge comes later, at least by", bounds.delay_min_clocks, bounds.delay_min_s, "delay-min"],
    ["and at most by", bounds.delay_max_clocks, bounds.delay_max_s, "delay-max"],
    ["Time between two samples", bounds.period_clocks, bounds.period_s, "period"],
  ];
  return (
    <>
      <table className="figures">
        <thead>
          <tr>
            <th scope="col">Bound</th>
            <th scope="col">Time</th>
            <th scope="col">Clocks</th>
          </tr>
        </thead>
        <tbody>
          {rows.map(([text, clocks, seconds, id]) => (
            <tr key={id} data-testid={`bound-${id}`}>
              <th scope="row">{text}</th>
              <td className="num">{timeText(seconds)}</td>
              <td className="num">{compact(clocks)}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <Text size="xs" c="dimmed" mt={6} data-testid="wave-counts">
        In the waveform above: {counts.passed.length} edges get through, {counts.stopped.length} pulses do not. A real
        edge lies between two clocks, so each time may be one clock ({timeText(bounds.period_s / bounds.period_clocks)})
        more.
      </Text>
    </>
  );
}
