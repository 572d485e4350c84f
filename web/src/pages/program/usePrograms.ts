import { useQuery } from "@tanstack/react-query";
import { useEffect, useMemo, useRef, useSyncExternalStore } from "react";
import { api, type Schemas } from "../../api/client";
import { type Device, useCatalogModel } from "../../api/queries";
import { useFollow } from "../../lib/useFollow";
import { WatchSource, type WatchState } from "./WatchSource";
import { constantsOf, type Words } from "./words";

export type Assembled = Schemas["AssembledProgram"];

/** What the editor knows of a module's language; null until it is there. */
export function useWords(device: Device): { words: Words | null; error: unknown; retry: () => void } {
  const catalog = useCatalogModel(device.model);
  const includes = useQuery({
    queryKey: ["program-includes", device.id],
    queryFn: () => api.GET("/api/v1/devices/{device}/program/includes", { path: { device: device.id } }),
    staleTime: Number.POSITIVE_INFINITY,
  });
  const { data: model } = catalog;
  const { data: found } = includes;
  const words = useMemo<Words | null>(
    () =>
      model && found
        ? {
            commands: model.commands,
            rows: model.rows,
            files: Object.fromEntries(Object.entries(found.files).map(([name, text]) => [name, constantsOf(text)])),
          }
        : null,
    [model, found],
  );
  return {
    words,
    error: catalog.error ?? includes.error,
    retry: () => {
      void catalog.refetch();
      void includes.refetch();
    },
  };
}

export const bodyOf = (name: string, text: string) => ({ name: name || "program.tmc", text, files: {} });

export interface Check {
  /** of the text before while `stale`; undefined before the first answer */
  result: Assembled | undefined;
  stale: boolean;
  error: unknown;
  /** as of the latest text without problems: they stay while a line is being typed */
  labels: Readonly<Record<string, number>>;
}

const NO_LABELS: Check["labels"] = {};

/** What the assembler says of a text: asked at each key, or as soon as it has answered the key before. */
export function useCheck(device: string, name: string, text: string, listing: boolean): Check {
  const { result, stale, error } = useFollow<Schemas["ProgramToAssemble"], Assembled>(
    { ...bodyOf(name, text), listing, binary: false },
    (body, signal) => api.POST("/api/v1/devices/{device}/program/assemble", { path: { device }, body, signal }),
  );
  const kept = useRef(NO_LABELS);
  // the same object as long as it says the same: a list of hundreds is not drawn anew for each key
  if (result?.problems.length === 0 && JSON.stringify(result.labels) !== JSON.stringify(kept.current))
    kept.current = result.labels;
  return { result, stale, error, labels: kept.current };
}

/** What the device's program does, for as long as the page is open. */
export function useWatch(device: string, variables: readonly number[]): WatchState {
  const source = useMemo(() => new WatchSource(device), [device]);
  useEffect(() => {
    source.start();
    return () => source.stop();
  }, [source]);
  useEffect(() => source.watch(variables), [source, variables]);
  return useSyncExternalStore(source.subscribe, source.snapshot);
}
