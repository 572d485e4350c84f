import { useQuery } from "@tanstack/react-query";
import { useEffect, useMemo, useState, useSyncExternalStore } from "react";
import { api, problemOf, type Schemas } from "../../api/client";
import { type Device, useCatalogModel } from "../../api/queries";
import { WatchSource, type WatchState } from "./WatchSource";
import { constantsOf, type Words } from "./words";

/** After the last key; the answer is to be there within a tenth of a second. */
const PAUSE_MS = 40;

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

export interface Checked {
  /** of which text it is said */
  text: string;
  result: Assembled;
}

export const bodyOf = (name: string, text: string) => ({ name: name || "program.tmc", text, files: {} });

/** What the assembler says of a text, soon after each key. */
export function useCheck(device: string, name: string, text: string): { checked: Checked | null; failure: string } {
  const [checked, setChecked] = useState<Checked | null>(null);
  const [failure, setFailure] = useState("");
  useEffect(() => {
    const ending = new AbortController();
    const timer = setTimeout(async () => {
      try {
        const result = await api.POST("/api/v1/devices/{device}/program/assemble", {
          path: { device },
          body: { ...bodyOf(name, text), listing: true, binary: false },
          signal: ending.signal,
        });
        setChecked({ text, result });
        setFailure("");
      } catch (error) {
        if (!ending.signal.aborted) setFailure(problemOf(error).detail);
      }
    }, PAUSE_MS);
    return () => {
      clearTimeout(timer);
      ending.abort();
    };
  }, [device, name, text]);
  return { checked, failure };
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
