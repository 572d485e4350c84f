import { Button, Tabs, Text } from "@mantine/core";
import { useHotkeys, useLocalStorage, useMediaQuery } from "@mantine/hooks";
import { IconTableColumn } from "@tabler/icons-react";
import { type RefObject, useMemo, useRef, useState } from "react";
import { Link } from "wouter";
import { problemOf } from "../../api/client";
import { useDevices } from "../../api/queries";
import { EmptyState } from "../../lib/EmptyState";
import { ProblemAlert } from "../../lib/ProblemAlert";
import type { RegisterRow } from "../../lib/rows/bits";
import { ChangesPanel } from "../../lib/rows/ChangesPanel";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { liveScale } from "../../lib/rows/physical";
import common from "../../lib/rows/rows.module.css";
import { StagedBar } from "../../lib/rows/StagedBar";
import { foldedByDefault, groupRows } from "../../lib/rows/search";
import { countChanges, type Key, keyOf, stage, unstage } from "../../lib/rows/staging";
import { updateStaged, useStaged } from "../../lib/rows/store";
import { Toolbar } from "../../lib/rows/Toolbar";
import { useApply } from "../../lib/rows/useApply";
import { useRegisters } from "../../lib/rows/useRegisters";
import { useSelection } from "../../live/selection";
import { ExchangeConsole } from "./ExchangeConsole";
import { RegisterHelp } from "./RegisterHelp";
import type { RowActions } from "./RegisterLine";
import { RegisterList } from "./RegisterList";

/** Every register of the selected device: look, understand, change. */
export default function RegistersPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  const phone = useMediaQuery("(max-width: 48em)", window.matchMedia("(max-width: 48em)").matches) ?? false;
  const [allAxes, setAllAxes] = useLocalStorage({ key: "stepscope.registers.all-axes", defaultValue: false });
  const [paused, setPaused] = useState(false);
  const [query, setQuery] = useState("");
  const [folded, setFolded] = useState<Record<string, boolean>>({});
  const [open, setOpen] = useState<ReadonlySet<Key>>(new Set());
  const [editing, setEditing] = useState<Key | null>(null);
  const [selectedKey, setSelectedKey] = useState<Key | null>(null);
  const [tab, setTab] = useState("register");
  const search = useRef<HTMLInputElement>(null);
  useHotkeys([["/", () => search.current?.focus()]]);

  const id = device?.id ?? "";
  const many = (device?.axes.length ?? 0) > 1;
  const everyAxis = allAxes && many;
  const live = useRegisters(device, paused);
  const staged = useStaged(id);
  const apply = useApply(id);
  const rows = live.catalog.data?.rows;
  const rowOf = useMemo(() => new Map<Key, RegisterRow>((rows ?? []).map((row) => [keyOf(row), row])), [rows]);
  const groups = useMemo(() => groupRows(rows ?? [], everyAxis ? null : axis, query), [rows, everyAxis, axis, query]);
  const actions = useActions(id, setOpen, setEditing, setSelectedKey);

  // One object per axis as long as its numbers stay, so that rows with an unchanged value do not render again.
  const scaleText = JSON.stringify(device?.axes.map((_, index) => liveScale(device, index, live.readings.data)) ?? []);
  const scales = useMemo(() => JSON.parse(scaleText) as ReturnType<typeof liveScale>[], [scaleText]);

  if (devices.isError && !device)
    return <ProblemAlert error={devices.error} doing="Looking for devices" retry={() => void devices.refetch()} />;
  if (devices.isSuccess && !device)
    return (
      <EmptyState title="No device to show registers of" icon={<IconTableColumn size={22} />}>
        <Text size="sm" className={common.dim}>
          Connect a chip, or add an emulated one: that needs no hardware.
        </Text>
        <Button component={Link} href="/connections" size="sm">
          Add a device
        </Button>
      </EmptyState>
    );

  const selected = (selectedKey === null ? undefined : rowOf.get(selectedKey)) ?? null;
  const selectedRaw = selectedKey === null ? null : (live.byKey.get(selectedKey)?.raw ?? null);
  const count = countChanges(staged.edits);
  const axisNames = device?.axes.map((entry) => entry.name) ?? [];
  const discard = (key: Key | null, field?: string) =>
    updateStaged(id, (now) => ({ edits: key === null ? [] : unstage(now.edits, key, field) }));
  const send = () =>
    apply.mutate(undefined, {
      onSuccess: ({ left }) => left > 0 && setTab("changes"),
      onError: () => setTab("changes"),
    });

  const list = (
    <RegisterList
      phone={phone}
      loading={live.catalog.isPending}
      groups={groups}
      query={query}
      isFolded={(group) => (query !== "" ? false : (folded[group.key] ?? foldedByDefault(group)))}
      onFold={(key, fold) => setFolded((now) => ({ ...now, [key]: fold }))}
      readings={live.byKey}
      edits={staged.edits}
      open={open}
      editing={editing}
      selected={selectedKey}
      scales={scales}
      clockHz={device?.clock_hz ?? 16e6}
      axisNames={axisNames}
      showAxis={everyAxis}
      old={live.old || !live.connected}
      actions={actions}
      onClearSearch={() => setQuery("")}
    />
  );
  const changes = (
    <ChangesPanel
      staged={staged}
      rows={rowOf}
      readings={live.byKey}
      axisNames={axisNames}
      error={apply.error}
      busy={apply.isPending}
      canApply={live.connected}
      onApply={send}
      onDiscard={discard}
    />
  );
  const exchange = (
    <ExchangeConsole device={id} connected={live.connected} rows={rows ?? []} selected={selected} raw={selectedRaw} />
  );
  return (
    <div className={common.page}>
      <h1 className={common.title}>Registers{device && <span>{`${device.name} · ${device.title}`}</span>}</h1>
      <Toolbar
        searchRef={search as RefObject<HTMLInputElement>}
        query={query}
        onQuery={setQuery}
        shown={groups.reduce((sum, group) => sum + group.rows.length, 0)}
        many={many}
        allAxes={everyAxis}
        onAllAxes={setAllAxes}
        paused={paused}
        onPaused={setPaused}
        connected={live.connected}
        known={live.readings.data !== undefined}
        ageMs={live.ageMs}
      />
      {device && <DeviceNotice device={device} />}
      {live.catalog.isError && (
        <ProblemAlert
          error={live.catalog.error}
          doing="Reading the register list"
          retry={() => void live.catalog.refetch()}
        />
      )}
      {live.connected && live.readings.isError && !isLost(live.readings.error) && (
        <ProblemAlert
          error={live.readings.error}
          doing="Reading registers"
          retry={() => void live.readings.refetch()}
        />
      )}
      <Tabs
        value={!phone && tab === "list" ? "register" : tab}
        onChange={(next) => setTab(next ?? "register")}
        keepMounted={false}
        classNames={{ root: common.body, panel: common.panel }}
      >
        {!phone && <div className={common.tablePane}>{list}</div>}
        <aside className={common.side} aria-label="Register, changes and console">
          <Tabs.List grow>
            <Tabs.Tab value="register">{phone ? "Registers" : "Register"}</Tabs.Tab>
            <Tabs.Tab value="changes" rightSection={count > 0 && <span className={common.tabBadge}>{count}</span>}>
              Changes
            </Tabs.Tab>
            <Tabs.Tab value="console">Console</Tabs.Tab>
          </Tabs.List>
          <Tabs.Panel value="register" {...(phone ? {} : { tabIndex: 0 })}>
            {phone ? (
              list
            ) : selected ? (
              <RegisterHelp row={selected} raw={selectedRaw} actions={actions} heading />
            ) : (
              <EmptyState title="Choose a register" icon={<IconTableColumn size={22} />}>
                <Text size="sm" className={common.dim} maw={270}>
                  Click a row, or walk the table with the arrow keys. <Shortcut keys="Enter" /> edits,{" "}
                  <Shortcut keys="→" /> opens the bits, <Shortcut keys="/" /> searches.
                </Text>
              </EmptyState>
            )}
          </Tabs.Panel>
          <Tabs.Panel value="changes">{changes}</Tabs.Panel>
          <Tabs.Panel value="console">{exchange}</Tabs.Panel>
        </aside>
      </Tabs>
      <StagedBar
        count={count}
        staged={staged}
        busy={apply.isPending}
        canApply={live.connected}
        onReview={() => setTab("changes")}
        onDiscard={() => discard(null)}
        onApply={send}
      />
    </div>
  );
}

/** Of a server that is gone the shell tells, on every page. */
function isLost(error: unknown): boolean {
  return problemOf(error).status === 0;
}

function Shortcut({ keys }: { keys: string }) {
  return <kbd className={common.kbd}>{keys}</kbd>;
}

/** What rows may ask for, the same object as long as the device is. */
function useActions(
  device: string,
  setOpen: (change: (now: ReadonlySet<Key>) => ReadonlySet<Key>) => void,
  setEditing: (key: Key | null) => void,
  setSelected: (key: Key) => void,
): RowActions {
  // biome-ignore lint/correctness/useExhaustiveDependencies: setters of useState never change
  return useMemo(
    () => ({
      select: setSelected,
      toggle: (key, open) =>
        setOpen((now) => {
          const next = new Set(now);
          if (open ?? !next.has(key)) next.add(key);
          else next.delete(key);
          return next;
        }),
      edit: setEditing,
      stage: (row, field, value, chip) =>
        updateStaged(device, (now) => ({ edits: stage(now.edits, row, field, value, chip) })),
      unstage: (key, field) => updateStaged(device, (now) => ({ edits: unstage(now.edits, key, field) })),
    }),
    [device],
  );
}
