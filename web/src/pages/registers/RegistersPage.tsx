import { Switch, Text } from "@mantine/core";
import { IconTableColumn } from "@tabler/icons-react";
import { useMemo } from "react";
import { useDevices } from "../../api/queries";
import { useAddressChoice } from "../../lib/address";
import { EmptyState } from "../../lib/EmptyState";
import { NoDevice } from "../../lib/NoDevice";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useRowState } from "../../lib/rows/actions";
import type { RegisterRow } from "../../lib/rows/bits";
import { liveScale } from "../../lib/rows/physical";
import { RowsPage } from "../../lib/rows/RowsPage";
import { besideText, foldedByDefault, groupRows } from "../../lib/rows/search";
import { type Key, keyOf } from "../../lib/rows/staging";
import { useStaged } from "../../lib/rows/store";
import { Toolbar, useRowsView } from "../../lib/rows/Toolbar";
import { useRegisters } from "../../lib/rows/useRegisters";
import { usePhone } from "../../lib/usePhone";
import { useSelection } from "../../live/selection";
import { ExchangeConsole } from "./ExchangeConsole";
import { RegisterHelp } from "./RegisterHelp";
import { RegisterList } from "./RegisterList";

/** Every register of the selected device: look, understand, change. */
export default function RegistersPage() {
  const devices = useDevices();
  const { device, axis } = useSelection();
  const phone = usePhone();
  const [axes, setAxes] = useAddressChoice("axes", ["one", "all"]);
  const view = useRowsView();
  const { paused, query } = view;

  const id = device?.id ?? "";
  const many = (device?.axes.length ?? 0) > 1;
  const everyAxis = axes === "all" && many;
  const live = useRegisters(device, paused, null, true);
  const staged = useStaged(id);
  const { open, editing, selected: selectedKey, actions } = useRowState(id);
  const rows = live.catalog.data?.rows;
  const rowOf = useMemo(() => new Map<Key, RegisterRow>((rows ?? []).map((row) => [keyOf(row), row])), [rows]);
  const groups = useMemo(() => groupRows(rows ?? [], everyAxis ? null : axis, query), [rows, everyAxis, axis, query]);

  // One object per axis as long as its numbers stay, so that rows with an unchanged value do not render again.
  const scaleText = JSON.stringify(device?.axes.map((_, index) => liveScale(device, index, live.readings.data)) ?? []);
  const scales = useMemo(() => JSON.parse(scaleText) as ReturnType<typeof liveScale>[], [scaleText]);

  if (devices.isError && !device)
    return (
      <Page name="Registers">
        <ProblemAlert error={devices.error} doing="Looking for devices" retry={() => void devices.refetch()} />
      </Page>
    );
  if (devices.isSuccess && !device)
    return (
      <NoDevice
        page="Registers"
        title="No device to show registers of"
        wanted="a chip"
        icon={<IconTableColumn size={22} />}
      />
    );

  const selected = (selectedKey === null ? undefined : rowOf.get(selectedKey)) ?? null;
  const selectedRaw = selectedKey === null ? null : (live.byKey.get(selectedKey)?.raw ?? null);
  const axisNames = device?.axes.map((entry) => entry.name) ?? [];

  return (
    <RowsPage
      name="Registers"
      one="register"
      many="registers"
      device={device}
      live={live}
      rows={rowOf}
      phone={phone}
      toolbar={
        <Toolbar
          what="registers"
          placeholder="Name, address, field or words of the help"
          view={view}
          live={live}
          groups={groups}
        >
          {many && (
            <Switch
              label="All axes"
              classNames={{ label: "text-12" }}
              checked={everyAxis}
              onChange={(event) => setAxes(event.currentTarget.checked ? "all" : "one")}
            />
          )}
        </Toolbar>
      }
      list={
        <RegisterList
          phone={phone}
          loading={live.catalog.isPending}
          groups={groups}
          rows={rows ?? []}
          query={query}
          isFolded={(group) => view.isFolded(group.key, foldedByDefault(group))}
          onFold={view.fold}
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
          onClearSearch={() => view.setQuery("")}
        />
      }
      help={
        selected ? (
          <RegisterHelp
            row={selected}
            raw={selectedRaw}
            beside={besideText(selected, rows ?? [])}
            actions={actions}
            heading
          />
        ) : (
          <EmptyState title="Choose a register" icon={<IconTableColumn size={22} />}>
            <Text size="sm" className="dim" maw={270}>
              Click a row, or walk the table with the arrow keys. <Shortcut keys="Enter" /> edits, <Shortcut keys="→" />{" "}
              opens the bits, <Shortcut keys="/" /> searches.
            </Text>
          </EmptyState>
        )
      }
      more={[
        {
          value: "console",
          label: "Console",
          panel: device && (
            <ExchangeConsole
              device={device}
              connected={live.connected}
              rows={rows ?? []}
              selected={selected}
              raw={selectedRaw}
            />
          ),
        },
      ]}
    />
  );
}

function Shortcut({ keys }: { keys: string }) {
  return <kbd className="tag mono">{keys}</kbd>;
}
