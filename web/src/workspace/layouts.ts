import { useQuery } from "@tanstack/react-query";
import { useEffect, useLayoutEffect, useMemo } from "react";
import { api, type Schemas } from "../api/client";
import { useAddress } from "../lib/address";
import { type Shared, stored, useShared } from "../lib/shared";
import { BENCH } from "./benchLayout";
import { builtInOf } from "./builtIn";
import { isNewer, type LayoutDocument } from "./document";
import { COPIES_KEY, FOUND, SAID, SAVED_KEY } from "./layout";
import { read } from "./reading";
import { useScopeOf } from "./scopeKept";

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
export const COPIES = layoutsIn(COPIES_KEY);
/** Each as it was last seen on the server: the first paint waits for no answer. */
export const SAVED = layoutsIn(SAVED_KEY);
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

export function useLayouts() {
  return useQuery({ queryKey: LAYOUTS_KEY, queryFn: () => api.GET("/api/v1/layouts"), staleTime: 10_000 });
}

/** Finds the layout that the address names: as it is in this browser, else as it is saved, else as it came. */
export function FindLayout(): null {
  const { layout } = useAddress("layout");
  const id = layout || BENCH.id;
  const copy = own(useShared(COPIES), id);
  const saved = own(useShared(SAVED), id);
  const list = useLayouts();
  const kept = list.data?.layouts.find((each) => each.id === id);
  useEffect(() => {
    if (list.data === undefined) return;
    if (kept === undefined) SAVED.set(without(SAVED.get(), id));
    else if (own(SAVED.get(), id)?.revision !== kept.revision) void bring(id);
  }, [list.data, kept, id]);
  const document = copy ?? saved ?? builtInOf(id);
  const unknown = document === undefined;
  const missing = unknown && list.data !== undefined && kept === undefined;
  const found = useMemo(
    () => ({
      id,
      document: document ?? BENCH,
      saved,
      touched: copy !== undefined,
      waiting: unknown && !missing,
      missing,
      put,
    }),
    [id, document, saved, copy, unknown, missing],
  );
  useLayoutEffect(() => FOUND.set(found), [found]);
  useScopeOf(found.waiting ? undefined : (saved ?? found.document));
  return null;
}

export function put(next: LayoutDocument, said: string): void {
  if (isNewer(next)) {
    SAID.set("A newer stepscope has made this layout: it is not changed here. Save it as another one first.");
    return;
  }
  SAID.set(said);
  COPIES.set({ ...COPIES.get(), [next.id]: next });
}

async function bring(id: string): Promise<void> {
  const document = documentOf(await api.GET("/api/v1/layouts/{layout}", { path: { layout: id } }));
  if (document) SAVED.set({ ...SAVED.get(), [id]: document });
}
