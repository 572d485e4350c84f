import { useQuery } from "@tanstack/react-query";
import { useCallback, useEffect, useMemo } from "react";
import { api, type Schemas } from "../api/client";
import { useAddress } from "../lib/address";
import { Shared, stored, useShared } from "../lib/shared";
import { BENCH, BUILT_IN, builtInOf } from "./builtIn";
import { isNewer, type LayoutDocument, read } from "./document";

type Copies = Readonly<Record<string, LayoutDocument>>;
export type LayoutInfo = Schemas["LayoutInfo"];

function layoutsIn(key: string): Shared<Copies> {
  return stored<Copies>("localStorage", key, (kept) =>
    Object.fromEntries(
      Object.entries(kept).flatMap(([id, raw]) => {
        const document = read(raw);
        return document ? [[id, document]] : [];
      }),
    ),
  );
}

/** What was changed of each layout in this browser and not yet saved, by the layout's id. */
export const COPIES = layoutsIn("stepscope.layouts");
/** Each as it was last seen on the server: the first paint waits for no answer. */
export const SAVED = layoutsIn("stepscope.layouts.saved");
/** What was just done to the layout, for those who do not see it. */
export const SAID = new Shared("");
/** The layout is being arranged. */
export const ARRANGING = new Shared(false);

export const LAYOUTS_KEY = ["layouts"];

export function without(copies: Copies, id: string): Copies {
  const { [id]: _, ...others } = copies;
  return others;
}

const own = (copies: Copies, id: string) => (Object.hasOwn(copies, id) ? copies[id] : undefined);

/** A layout of the server, as a document whose id and revision are those that it is kept by. */
export function documentOf({ id, revision, document }: Schemas["LayoutDetail"]): LayoutDocument | null {
  return read({ ...document, id, revision });
}

export interface Layout {
  id: string;
  document: LayoutDocument;
  /** on the server; undefined where it was never saved */
  saved: LayoutDocument | undefined;
  /** it differs from what is saved, or from what it was at first */
  touched: boolean;
  /** nobody knows yet whether there is such a layout */
  waiting: boolean;
  /** there is none: the bench is shown */
  missing: boolean;
  put: (document: LayoutDocument, said: string) => void;
}

export function useLayouts() {
  return useQuery({ queryKey: LAYOUTS_KEY, queryFn: () => api.GET("/api/v1/layouts"), staleTime: 10_000 });
}

/** The layout that the address names: as it is in this browser, else as it is saved, else as it came. */
export function useLayout(): Layout {
  const { layout } = useAddress("layout");
  const id = layout || BENCH;
  const copy = own(useShared(COPIES), id);
  const seen = own(useShared(SAVED), id);
  const list = useLayouts();
  const kept = list.data?.layouts.find((each) => each.id === id);
  useEffect(() => {
    if (list.data === undefined) return;
    if (kept === undefined) SAVED.set(without(SAVED.get(), id));
    else if (own(SAVED.get(), id)?.revision !== kept.revision) void bring(id);
  }, [list.data, kept, id]);
  const found = copy ?? seen ?? builtInOf(id);
  const put = useCallback((next: LayoutDocument, said: string) => {
    if (isNewer(next)) {
      SAID.set("A newer stepscope has made this layout: it is not changed here. Save it as another one first.");
      return;
    }
    SAID.set(said);
    COPIES.set({ ...COPIES.get(), [next.id]: next });
  }, []);
  const unknown = found === undefined;
  const missing = unknown && list.data !== undefined && kept === undefined;
  return useMemo(
    () => ({
      id,
      document: found ?? (BUILT_IN[0] as LayoutDocument),
      saved: seen,
      touched: copy !== undefined,
      waiting: unknown && !missing,
      missing,
      put,
    }),
    [id, found, seen, copy, unknown, missing, put],
  );
}

async function bring(id: string): Promise<void> {
  const document = documentOf(await api.GET("/api/v1/layouts/{layout}", { path: { layout: id } }));
  if (document) SAVED.set({ ...SAVED.get(), [id]: document });
}
