import { useCallback, useMemo } from "react";
import { putIntoAddress, useAddress } from "../../lib/address";
import { coordinate } from "../../lib/format";
import type { Window } from "./ZoomData";

/** `t` of the address: the stretch that is shown, in seconds, as "3.2~4.9"; null: all of it. */
export function windowOf(text: string): Window | null {
  const [from, to, ...rest] = text.split("~").map((part) => (part.trim() === "" ? Number.NaN : Number(part)));
  if (from === undefined || to === undefined || rest.length > 0) return null;
  return Number.isFinite(from) && Number.isFinite(to) && from < to ? [from, to] : null;
}

/** To the microsecond, which is finer than any sample. */
export function textOf(window: Window | null): string {
  return window === null ? "" : window.map((time) => String(Number(coordinate(time, 6)))).join("~");
}

/** What of a recording is shown: the stretch, of which Back brings the one before, and which channels are not. */
export function useView() {
  const { t, hide } = useAddress("t", "hide");
  const window = useMemo(() => windowOf(t), [t]);
  const hidden = useMemo<ReadonlySet<string>>(() => new Set(hide === "" ? [] : hide.split(",")), [hide]);
  const setWindow = useCallback((next: Window | null) => putIntoAddress({ t: textOf(next) }, "step"), []);
  const setHidden = useCallback(
    (next: ReadonlySet<string>) => putIntoAddress({ hide: [...next].join(",") }, "replace"),
    [],
  );
  return { window, setWindow, hidden, setHidden };
}
