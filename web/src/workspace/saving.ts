/** Layouts on their way to the server and back. */
import type { QueryClient } from "@tanstack/react-query";
import { api } from "../api/client";
import { putIntoAddress } from "../lib/address";
import { fileName, saveText } from "../lib/files";
import { BENCH } from "./benchLayout";
import { builtInOf } from "./builtIn";
import { type LayoutDocument, VERSION } from "./document";
import { SAID } from "./layout";
import { COPIES, documentOf, LAYOUTS_KEY, SAVED, without } from "./layouts";
import { read } from "./reading";
import { withScope } from "./scopeKept";

function kept(queries: QueryClient, document: LayoutDocument | null, said: string): void {
  if (document) {
    SAVED.set({ ...SAVED.get(), [document.id]: document });
    COPIES.set(without(COPIES.get(), document.id));
  }
  SAID.set(said);
  void queries.invalidateQueries({ queryKey: LAYOUTS_KEY });
}

/** Over the revision that it was made from; `over`: over whatever revision there is now. */
export async function save(queries: QueryClient, document: LayoutDocument, over?: number): Promise<void> {
  const body = { based_on: over ?? document.revision, document: { ...withScope(document) } };
  const answer = await api.PUT("/api/v1/layouts/{layout}", { path: { layout: document.id }, body });
  kept(queries, documentOf(answer), `Layout ${document.name} is saved`);
}

/** Under another name, and goes there. */
export async function saveAs(queries: QueryClient, document: LayoutDocument, name: string): Promise<void> {
  const body = { document: { ...document, name, version: VERSION } };
  const saved = documentOf(await api.POST("/api/v1/layouts", { body }));
  if (saved && document.revision > 0) COPIES.set(without(COPIES.get(), document.id));
  kept(queries, saved, `Layout ${name} is saved`);
  if (saved) show(saved.id);
}

/** Forgets what was changed here. */
export function revert({ id, name }: LayoutDocument): void {
  COPIES.set(without(COPIES.get(), id));
  SAID.set(`Layout ${name} is as it was saved`);
}

/** Back to what came with the program; what is saved on the server stays until this is saved over it. */
export function reset({ id, revision, name }: LayoutDocument): void {
  const first = builtInOf(id);
  if (!first) return;
  COPIES.set(revision === 0 ? without(COPIES.get(), id) : { ...COPIES.get(), [id]: { ...first, revision } });
  SAID.set(`Layout ${name} is as it came`);
}

export async function remove(queries: QueryClient, { id, name }: LayoutDocument): Promise<void> {
  await api.DELETE("/api/v1/layouts/{layout}", { path: { layout: id } });
  COPIES.set(without(COPIES.get(), id));
  SAVED.set(without(SAVED.get(), id));
  kept(queries, null, `Layout ${name} is deleted`);
  if (!builtInOf(id)) show(BENCH.id);
}

export function show(id: string): void {
  putIntoAddress({ layout: id === BENCH.id ? "" : id, max: "" }, "step");
}

export function exportFile(document: LayoutDocument): void {
  saveText(
    fileName(document.name, ".layout.json"),
    `${JSON.stringify(withScope(document), null, 2)}\n`,
    "application/json",
  );
}

/** A layout out of a file. Throws where there is none in it. */
export async function importFile(queries: QueryClient, file: File): Promise<void> {
  const wrong = `${file.name} is no layout: export one here to see what a layout looks like.`;
  let raw: unknown;
  try {
    raw = JSON.parse(await file.text());
  } catch {
    throw new Error(wrong);
  }
  const document = read(raw);
  if (document === null) throw new Error(wrong);
  await saveAs(queries, { ...document, revision: 0 }, document.name);
}
