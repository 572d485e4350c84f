import { TextInput } from "@mantine/core";
import { IconSearch } from "@tabler/icons-react";
import { useMemo, useState } from "react";
import { Card } from "../../lib/Card";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useRowState } from "../../lib/rows/actions";
import { liveScale } from "../../lib/rows/physical";
import { foldedByDefault, groupRows } from "../../lib/rows/search";
import { useStaged } from "../../lib/rows/store";
import { useRegisters } from "../../lib/rows/useRegisters";
import { RegisterList } from "../../pages/registers/RegisterList";
import type { DeviceProps } from "../panel";
import type { RegistersConfig } from "./registers";

/** The registers of an axis, live; what is edited waits in the panel of changes. */
export function RegistersPanel({ device, axis, config, change }: DeviceProps<RegistersConfig>) {
  const [find, setFind] = useState(config.find);
  const [folded, setFolded] = useState<Readonly<Record<string, boolean>>>({});
  const live = useRegisters(device, false, null, true);
  const { edits } = useStaged(device.id);
  const { open, editing, selected, actions } = useRowState(device.id);
  const rows = live.catalog.data?.rows ?? [];
  const index = axis?.index ?? null;
  const scales = useMemo(
    () => device.axes.map((_, each) => liveScale(device, each, live.readings.data)),
    [device, live.readings.data],
  );
  return (
    <Card
      title="Registers"
      note={axis && device.axes.length > 1 ? `${device.name} ${axis.name}` : device.name}
      className="text-13"
      actions={
        <TextInput
          size="xs"
          w={220}
          aria-label="Search registers"
          placeholder="Name, address or field"
          leftSection={<IconSearch size={14} aria-hidden />}
          value={find}
          onChange={(event) => setFind(event.currentTarget.value)}
          onBlur={() => find !== config.find && change({ find })}
        />
      }
    >
      {live.catalog.isError && (
        <ProblemAlert
          error={live.catalog.error}
          doing="Reading the register list"
          retry={() => void live.catalog.refetch()}
        />
      )}
      <RegisterList
        phone
        loading={live.catalog.isPending}
        groups={groupRows(rows, index, find)}
        rows={rows}
        query={find}
        isFolded={(group) => find === "" && (folded[group.key] ?? foldedByDefault(group))}
        onFold={(key, fold) => setFolded((now) => ({ ...now, [key]: fold }))}
        readings={live.byKey}
        edits={edits}
        open={open}
        editing={editing}
        selected={selected}
        scales={scales}
        clockHz={device.clock_hz}
        axisNames={device.axes.map(({ name }) => name)}
        showAxis={false}
        old={live.old || !live.connected}
        actions={actions}
        onClearSearch={() => setFind("")}
      />
    </Card>
  );
}
