import { useQuery } from "@tanstack/react-query";
import { useMemo } from "react";
import { api } from "../../api/client";
import { useCatalogModel, useDevices } from "../../api/queries";
import { useSteps } from "../../lib/history/history";
import { useShared } from "../../lib/shared";
import { useLocalKept } from "../../lib/useKept";
import { useScheme } from "../../lib/useScheme";
import { useSelection } from "../../live/selection";
import { useProfiles } from "../../pages/profiles/useProfiles";
import { PAGE_MAX, useRecordings } from "../../pages/recordings/api";
import { allLayouts } from "../../workspace/builtIn";
import { FOUND } from "../../workspace/layout";
import { useLayouts } from "../../workspace/layouts";
import { PANELS } from "../../workspace/panels";
import { PAGES } from "../pages";
import {
  actionEntries,
  axisEntries,
  type Entry,
  type HelpItem,
  helpEntries,
  historyEntries,
  layoutEntries,
  macroEntries,
  pageEntries,
  panelEntries,
  profileEntries,
  recordingEntries,
  registerEntries,
} from "./entries";
import { Index } from "./find";

const RECENT = "stepscope.found";
const RECENT_MAX = 8;

/** The index of the help; a server that was started without one has none. */
async function helpIndex(): Promise<HelpItem[]> {
  const answer = await fetch("/help/search.json");
  if (!answer.ok) return [];
  return ((await answer.json()) as { items: HelpItem[] }).items;
}

export interface Found {
  entries: readonly Entry[];
  /** how many there are to be found */
  searched: number;
  /** these are what was chosen last */
  recent: boolean;
  waiting: boolean;
}

/** What fits a query, or what was chosen last where there is none. */
export function useFound(query: string): Found {
  const devices = useDevices();
  const { device, axis } = useSelection();
  const layout = useShared(FOUND)?.document;
  const scheme = useScheme();
  const steps = useSteps();
  const catalog = useCatalogModel(device?.model);
  const recordings = useRecordings("", PAGE_MAX);
  const profiles = useProfiles("");
  const help = useQuery({ queryKey: ["find", "help"], queryFn: helpIndex, staleTime: Number.POSITIVE_INFINITY });
  const kept = useLayouts();
  const macros = useQuery({ queryKey: ["macros"], queryFn: () => api.GET("/api/v1/macros") });
  const [recent] = useRecent();

  const index = useMemo(
    () =>
      new Index([
        ...actionEntries(scheme),
        ...historyEntries(steps, device),
        ...pageEntries(PAGES, device),
        ...axisEntries(devices.data ?? []),
        ...layoutEntries(allLayouts(kept.data?.layouts ?? [])),
        ...panelEntries(PANELS, layout, device, axis),
        ...macroEntries(macros.data?.macros ?? []),
        ...registerEntries(catalog.data, device),
        ...recordingEntries(recordings.data?.recordings ?? []),
        ...profileEntries(profiles.data ?? []),
        ...helpEntries(help.data ?? []),
      ]),
    [
      scheme,
      steps,
      device,
      axis,
      layout,
      devices.data,
      kept.data,
      macros.data,
      catalog.data,
      recordings.data,
      profiles.data,
      help.data,
    ],
  );
  const entries = useMemo(() => {
    if (query.trim() !== "") return index.find(query);
    const known = new Map(index.entries.map((entry) => [entry.id, entry]));
    return recent.flatMap((id) => known.get(id) ?? []);
  }, [index, query, recent]);
  const waiting = [catalog, recordings, profiles, help].some(({ isLoading }) => isLoading);
  return { entries, searched: index.entries.length, recent: query.trim() === "", waiting };
}

/** What was chosen last, the latest first, and how one more is remembered. */
export function useRecent(): [readonly string[], (id: string) => void] {
  const [recent, setRecent] = useLocalKept<readonly string[]>(RECENT, []);
  return [recent, (id) => setRecent([id, ...recent.filter((other) => other !== id)].slice(0, RECENT_MAX))];
}
