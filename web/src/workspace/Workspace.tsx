import { VisuallyHidden } from "@mantine/core";
import { memo, Suspense, useCallback, useContext, useEffect, useMemo, useRef, useState } from "react";
import { createPortal } from "react-dom";
import type { Device } from "../api/queries";
import { useAddress } from "../lib/address";
import { Card } from "../lib/Card";
import { later, lazily } from "../lib/later";
import { useShared } from "../lib/shared";
import { usePhone } from "../lib/usePhone";
import { useSelection } from "../live/selection";
import { PageBoundary } from "../shell/PageBoundary";
import { WorkspaceContext } from "./context";
import { alone, idsIn, isNewer, type PanelEntry, SELECTED, set, shownIn } from "./document";
import { Hosts, HostsContext } from "./hosts";
import { ARRANGING, SAID } from "./layout";
import { misfit } from "./panel";
import { titleOf, typeOf } from "./panels";
import { Stack } from "./Stack";
import { StaticDock } from "./StaticDock";
import { Tools } from "./Tools";
import { useLayout } from "./useLayout";
import css from "./workspace.module.css";

const Dock = lazily(() => import("./Dock").then((part) => part.Dock));
const FindLayout = later(() => import("./layouts").then((part) => part.FindLayout), false);
const Misfit = later(() => import("./Misfit").then((part) => part.Misfit));

let rounds: typeof import("./rounds") | undefined;

interface Props {
  devices: readonly Device[];
  lost: boolean;
}

/** The panels of a layout. Each is rendered once, into a box of its own that goes wherever the layout has its place. */
export function Workspace({ devices, lost }: Props) {
  const layout = useLayout();
  const { document, put, waiting, missing } = layout;
  const { max } = useAddress("max");
  const phone = usePhone();
  const said = useShared(SAID);
  const arranging = useShared(ARRANGING) && !phone && max === "" && !waiting && !isNewer(document);
  useEffect(() => () => ARRANGING.set(false), []);
  const [hosts] = useState(() => new Hosts());
  const desktop = Object.hasOwn(document.panels, max) ? alone(document, max) : document.screens.desktop;
  const state = useMemo(() => ({ document, put }), [document, put]);
  const now = useRef(document);
  now.current = document;
  useEffect(() => {
    const go = (event: KeyboardEvent) => {
      if (event.key !== "F6" || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      const round = () => rounds?.goRound(() => now.current, event.shiftKey);
      if (rounds) round();
      else
        void import("./rounds").then((part) => {
          rounds = part;
          round();
        });
    };
    window.addEventListener("keydown", go);
    return () => window.removeEventListener("keydown", go);
  }, []);
  const seen = useRef(new Set<string>());
  const inSight = new Set(phone ? document.screens.phone : shownIn(desktop));
  for (const id of inSight) seen.current.add(id);
  // hidden panels hold no channels, but for those that would have to load anew
  const shown = idsIn(document.screens.desktop).filter(
    (id) => inSight.has(id) || (seen.current.has(id) && typeOf(document.panels[id]?.type)?.keeps),
  );
  const still = (
    <StaticDock
      document={document}
      part={desktop}
      onShow={async (id) => {
        const { brought } = await import("./edits");
        put(brought(document, id), `${titleOf(document, id)} is shown`);
      }}
    />
  );
  return (
    <HostsContext value={hosts}>
      <WorkspaceContext value={state}>
        <div ref={hosts.settle} hidden />
        {missing && <p className="card pad m-0 mb-8">This server has no layout of that name: this is the bench.</p>}
        {isNewer(document) && (
          <p className="card pad m-0 mb-8">
            A newer stepscope has made this layout: it is shown as far as this one knows it, and never changed.
          </p>
        )}
        {waiting ? null : phone ? (
          <Stack document={document} />
        ) : arranging ? (
          <Suspense fallback={still}>
            <Dock key={document.id} document={document} put={put} />
          </Suspense>
        ) : (
          still
        )}
        {shown.map((id) => {
          const entry = document.panels[id];
          const fills = typeOf(entry?.type)?.fills === true && !phone;
          return (
            entry &&
            createPortal(
              <PageBoundary>
                <Panel id={id} entry={entry} devices={devices} lost={lost} />
              </PageBoundary>,
              hosts.box(id, `${css.host} ${fills ? css.fills : ""}`),
              id,
            )
          );
        })}
        <FindLayout />
        <Tools layout={layout} />
        <VisuallyHidden role="status" data-testid="layout-said">
          {said}
        </VisuallyHidden>
      </WorkspaceContext>
    </HostsContext>
  );
}

interface PanelBox extends Props {
  id: string;
  entry: PanelEntry;
}

const Panel = memo(function Panel({ id, entry, devices, lost }: PanelBox) {
  const { document, put } = useContext(WorkspaceContext);
  const selection = useSelection();
  const now = useRef(document);
  now.current = document;
  const type = typeOf(entry.type);
  const config = useMemo(() => type?.config(entry.config, entry.v) ?? {}, [type, entry]);
  const change = useCallback(
    (part: object) =>
      put(set(now.current, id, { config: { ...config, ...part }, v: type?.version ?? 0 }), "The panel is set"),
    [put, id, config, type],
  );
  const [deviceId, index] = entry.at === SELECTED ? [null, selection.axis] : pinOf(entry.at);
  const found = deviceId === null ? selection.device : devices.find((each) => each.id === deviceId);
  const device = useMemo(
    (): Device | undefined => found && (lost ? { ...found, state: "disconnected" } : found),
    [found, lost],
  );
  const axis = device?.axes.find((each) => each.index === index) ?? (deviceId === null ? device?.axes[0] : undefined);
  if (type === undefined) return <Misfit title={entry.type} why="This version of stepscope has no such panel." />;
  const why = misfit(type, device, axis);
  if (why !== null) return type.quiet ? null : <Misfit title={type.title} why={why} />;
  return (
    <Suspense fallback={<Card title={type.title} note="loading" className="grow" role="status" />}>
      <type.Panel id={id} config={config} change={change} device={device} axis={axis} devices={devices} lost={lost} />
    </Suspense>
  );
});

function pinOf(at: string): readonly [device: string, axis: number] {
  const cut = at.lastIndexOf("/");
  return [at.slice(0, cut), Number(at.slice(cut + 1))];
}
