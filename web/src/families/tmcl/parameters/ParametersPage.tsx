import { Text } from "@mantine/core";
import { IconAdjustments } from "@tabler/icons-react";
import { useMemo, useRef } from "react";
import { useCatalogModel, useDevices } from "../../../api/queries";
import { EmptyState } from "../../../lib/EmptyState";
import { NoDevice } from "../../../lib/NoDevice";
import { Page } from "../../../lib/Page";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { useRowState } from "../../../lib/rows/actions";
import type { RegisterRow } from "../../../lib/rows/bits";
import { RowsPage } from "../../../lib/rows/RowsPage";
import { type Key, keyOf } from "../../../lib/rows/staging";
import { useStaged } from "../../../lib/rows/store";
import { Toolbar, useRowsView } from "../../../lib/rows/Toolbar";
import { useRegisters } from "../../../lib/rows/useRegisters";
import { scaleOf } from "../../../lib/units";
import { usePhone } from "../../../lib/usePhone";
import { useSelection } from "../../../live/selection";
import { useEeprom } from "./eeprom";
import { lackingOf } from "./lacking";
import { ParameterHelp } from "./ParameterHelp";
import type { LineActions } from "./ParameterLine";
import { ParameterList } from "./ParameterList";
import { type Context, unitModeOf } from "./quantities";
import { Subjects } from "./Subjects";
import { foldedAtFirst, subjectsOf } from "./subjects";
import { useRead } from "./useRead";

/** Every parameter of a module, by subject: look, understand, change. */
export default function ParametersPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  const phone = usePhone();
  const view = useRowsView();
  const { paused, query } = view;

  const id = device?.id ?? "";
  const catalog = useCatalogModel(device?.model);
  const rows = catalog.data?.rows;
  const rowOf = useMemo(() => new Map<Key, RegisterRow>((rows ?? []).map((row) => [keyOf(row), row])), [rows]);
  const groups = useMemo(() => subjectsOf(rows ?? [], query), [rows, query]);
  const staged = useStaged(id);
  const isFolded = (key: string) => view.isFolded(key, foldedAtFirst(key, axis));
  // A slow wire is asked only for what is looked at, for what edits wait in, and for what tells units.
  const asking = new Set(["units", "motor", "current"]);
  for (const group of groups) if (!isFolded(group.key)) asking.add(group.key);
  for (const edit of staged.edits) asking.add(rowOf.get(keyOf(edit))?.group ?? "motor");
  const live = useRegisters(device, paused, rows ? [...asking].sort() : []);
  const lacking = useMemo(() => lackingOf(rows ?? [], live.byKey), [rows, live.byKey]);
  const { open, editing, selected: selectedKey, actions } = useRowState(id);
  const eeprom = useEeprom(id);
  const asked = useRead(id);

  const of = (name: string) => live.byKey.get(keyOf({ name, axis }))?.value;
  const info = device?.axes[axis];
  const contextText = JSON.stringify({
    scale: info ? scaleOf(info, device.clock_hz) : null,
    mode: unitModeOf(of("unit_mode")),
    clockHz: device?.clock_hz ?? 16e6,
    globalScaler: of("global_current_scaler") ?? null,
  } satisfies Context);
  // One object as long as its numbers stay, so that rows with an unchanged value do not render again.
  const context = useMemo(() => JSON.parse(contextText) as Context, [contextText]);
  const copy = useRef(eeprom.run);
  const read = useRef(asked.run);
  copy.current = eeprom.run;
  read.current = asked.run;
  const lineActions = useMemo<LineActions>(
    () => ({
      ...actions,
      copy: (row, action) => copy.current(row, action),
      read: (row) => read.current(row),
    }),
    [actions],
  );

  if (devices.isError && !device)
    return (
      <Page name="Parameters">
        <ProblemAlert error={devices.error} doing="Looking for devices" retry={() => void devices.refetch()} />
      </Page>
    );
  if (devices.isSuccess && !device)
    return (
      <>
        <h1 className="flex baseline gap-8 m-0 text-16">Parameters</h1>
        <NoDevice title="No module to show parameters of" wanted="a module" icon={<IconAdjustments size={22} />} />
      </>
    );

  const selected = (selectedKey === null ? undefined : rowOf.get(selectedKey)) ?? null;
  const jump = (key: string) => {
    view.fold(key, false);
    // after the rows are there
    requestAnimationFrame(() =>
      document.querySelector(`[data-subject="${CSS.escape(key)}"]`)?.scrollIntoView({ block: "start" }),
    );
  };

  return (
    <RowsPage
      name="Parameters"
      one="parameter"
      many="parameters"
      device={device}
      live={live}
      rows={rowOf}
      phone={phone}
      toolbar={
        <Toolbar
          what="parameters"
          placeholder="Name, number like AP 4, or words of the help"
          view={view}
          live={live}
          groups={groups}
        />
      }
      above={
        <>
          {eeprom.error !== null && <ProblemAlert error={eeprom.error} doing={eeprom.doing} onClose={eeprom.dismiss} />}
          {asked.error !== null && (
            <ProblemAlert error={asked.error} doing="Reading the parameter" onClose={asked.dismiss} />
          )}
          <Subjects groups={groups} edits={staged.edits} onJump={jump} />
        </>
      }
      list={
        <ParameterList
          phone={phone}
          loading={live.catalog.isPending}
          groups={groups}
          query={query}
          isFolded={(group) => isFolded(group.key)}
          onFold={view.fold}
          readings={live.byKey}
          lacking={lacking}
          edits={staged.edits}
          open={open}
          editing={editing}
          selected={selectedKey}
          context={context}
          connected={live.connected}
          old={live.old || !live.connected}
          kept={eeprom.kept}
          copying={eeprom.busy}
          answers={asked.answers}
          asking={asked.busy}
          actions={lineActions}
          onClearSearch={() => view.setQuery("")}
        />
      }
      help={
        selected ? (
          <ParameterHelp
            row={selected}
            context={context}
            lacking={selectedKey !== null && lacking.has(selectedKey)}
            heading
          />
        ) : (
          <EmptyState title="Choose a parameter" icon={<IconAdjustments size={22} />}>
            <Text size="sm" className="dim" maw={270}>
              Click a row, or walk the table with the arrow keys. <kbd className="tag mono">Enter</kbd> edits,{" "}
              <kbd className="tag mono">/</kbd> searches.
            </Text>
          </EmptyState>
        )
      }
    />
  );
}
