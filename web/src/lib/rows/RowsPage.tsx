import { Tabs } from "@mantine/core";
import type { ReactNode } from "react";
import { problemOf } from "../../api/client";
import type { Device } from "../../api/queries";
import { useAddressChoice } from "../address";
import { Card } from "../Card";
import { ProblemAlert } from "../ProblemAlert";
import { TierBadge } from "../TierBadge";
import type { RegisterRow } from "./bits";
import { ChangesPanel } from "./ChangesPanel";
import { DeviceNotice } from "./DeviceNotice";
import css from "./rows.module.css";
import { StagedBar } from "./StagedBar";
import { countChanges, type Key } from "./staging";
import { discardStaged, useStaged } from "./store";
import { useApply } from "./useApply";
import type { Live } from "./useRegisters";

export interface ExtraTab {
  value: string;
  label: string;
  panel: ReactNode;
}

interface Props {
  /** the heading: "Registers" */
  name: string;
  /** one and many of what the page lists */
  one: string;
  many: string;
  device: Device | undefined;
  live: Live;
  rows: ReadonlyMap<Key, RegisterRow>;
  phone: boolean;
  toolbar: ReactNode;
  /** between toolbar and table */
  above?: ReactNode;
  list: ReactNode;
  /** of the selected row */
  help: ReactNode;
  more?: readonly ExtraTab[];
}

/** A page that lists what a device holds: the table, beside it help and changes, below it what waits to be applied. */
export function RowsPage(props: Props) {
  const { name, one, many, device, live, rows, phone, toolbar, above, list, help, more = [] } = props;
  const id = device?.id ?? "";
  const [tab, setTab] = useAddressChoice("tab", ["row", "changes", ...more.map(({ value }) => value)]);
  const staged = useStaged(id);
  const apply = useApply(id);
  const count = countChanges(staged.edits);
  const discard = (key: Key | null, field?: string) => discardStaged(id, key, field);
  const send = () =>
    apply.mutate(undefined, {
      onSuccess: ({ left }) => left > 0 && setTab("changes"),
      onError: () => setTab("changes"),
    });

  return (
    <div className={`${css.page} stack gap-8 text-13`}>
      <h1 className="flex baseline gap-8 m-0 text-16">
        {name}
        {device && <span className="text-13 regular dim">{`${device.name} · ${device.title}`}</span>}
        {device && <TierBadge device={device} />}
      </h1>
      {toolbar}
      {device && <DeviceNotice device={device} />}
      {live.catalog.isError && (
        <ProblemAlert
          error={live.catalog.error}
          doing={`Reading the ${one} list`}
          retry={() => void live.catalog.refetch()}
        />
      )}
      {live.connected && live.readings.isError && !isLost(live.readings.error) && (
        <ProblemAlert
          error={live.readings.error}
          doing={`Reading ${many}`}
          retry={() => void live.readings.refetch()}
        />
      )}
      {above}
      <Tabs
        value={tab}
        onChange={(next) => setTab(next ?? "row")}
        keepMounted={false}
        classNames={{ root: `${css.body} grid grow gap-8`, panel: css.panel }}
      >
        {!phone && (
          <Card as="div" className={`${css.tablePane} scroll relative`}>
            {list}
          </Card>
        )}
        <Card as="aside" className={`${css.side} stack`} aria-label={`${capital(one)} and changes`}>
          <Tabs.List grow>
            <Tabs.Tab value="row">{phone ? name : capital(one)}</Tabs.Tab>
            <Tabs.Tab value="changes" rightSection={count > 0 && <span className="count">{count}</span>}>
              Changes
            </Tabs.Tab>
            {more.map((extra) => (
              <Tabs.Tab key={extra.value} value={extra.value}>
                {extra.label}
              </Tabs.Tab>
            ))}
          </Tabs.List>
          <Tabs.Panel value="row" {...(phone ? {} : { tabIndex: 0 })}>
            {phone ? list : help}
          </Tabs.Panel>
          <Tabs.Panel value="changes">
            <ChangesPanel
              what={{ one, many }}
              staged={staged}
              rows={rows}
              readings={live.byKey}
              axisNames={device?.axes.map((entry) => entry.name) ?? []}
              error={apply.error}
              busy={apply.isPending}
              canApply={live.connected}
              onApply={send}
              onDiscard={discard}
            />
          </Tabs.Panel>
          {more.map((extra) => (
            <Tabs.Panel key={extra.value} value={extra.value}>
              {extra.panel}
            </Tabs.Panel>
          ))}
        </Card>
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

function capital(word: string): string {
  return word.charAt(0).toUpperCase() + word.slice(1);
}

/** Of a server that is gone the shell tells, on every page. */
function isLost(error: unknown): boolean {
  return problemOf(error).status === 0;
}
