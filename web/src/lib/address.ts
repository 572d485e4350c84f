import { useCallback, useEffect, useMemo, useState } from "react";
import { navigate, useLocationProperty } from "wouter/use-browser-location";

/** A change of the address is a step that Back undoes, or takes the place of what was there. */
export type Keeping = "step" | "replace";

type Texts<K extends string> = Readonly<Record<K, string>>;

/** Typing and walking with held keys are faster than a browser lets a page change its address. */
const SETTLED_MS = 300;

/** The address of this page with some texts changed: "" leaves a key out. No spaces and no plus, which mails break. */
export function addressWith(change: Readonly<Record<string, string>>, at: URL | Location = location): string {
  const texts = new URLSearchParams(at.search);
  for (const [key, text] of Object.entries(change)) {
    if (text === "") texts.delete(key);
    else texts.set(key, text);
  }
  const search = [...texts].map(
    ([key, text]) => `${key}=${encodeURIComponent(text).replace(/%(2C|2F|3A)/g, readable)}`,
  );
  return search.length === 0 ? at.pathname : `${at.pathname}?${search.join("&")}`;
}

const readable = (code: string) => decodeURIComponent(code);

/** Puts texts into the address of this page. */
export function putIntoAddress(change: Readonly<Record<string, string>>, keeping: Keeping): void {
  const next = addressWith(change);
  if (next !== location.pathname + location.search) navigate(next, { replace: keeping === "replace" });
}

/** What the address of this page says under some keys; "" where it says nothing. Rendered anew when that changes. */
export function useAddress<K extends string>(...keys: readonly K[]): Texts<K> {
  const said = useLocationProperty(() => {
    const texts = new URLSearchParams(location.search);
    return JSON.stringify(Object.fromEntries(keys.map((key) => [key, texts.get(key) ?? ""])));
  });
  return useMemo(() => JSON.parse(said) as Texts<K>, [said]);
}

/** One of a few that the address holds under `key`; the first of them where it holds none. */
export function useAddressChoice<V extends string>(key: string, values: readonly [V, ...V[]]) {
  const { [key]: said } = useAddress(key);
  const change = useCallback(
    (next: V) => putIntoAddress({ [key]: next === values[0] ? "" : next }, "replace"),
    [key, values[0]],
  );
  return [values.find((value) => value === said) ?? values[0], change] as const;
}

/** A text that changes fast: the address holds it as soon as it has stood still, and sets it when it is another one. */
export function useAddressText(key: string) {
  const { [key]: said = "" } = useAddress(key);
  const [text, setText] = useState(said);
  const [seen, setSeen] = useState(said);
  if (said !== seen) {
    setSeen(said);
    setText(said);
  }
  useEffect(() => {
    if (text === said) return;
    const timer = setTimeout(() => putIntoAddress({ [key]: text }, "replace"), SETTLED_MS);
    return () => clearTimeout(timer);
  }, [key, text, said]);
  return [text, setText] as const;
}
