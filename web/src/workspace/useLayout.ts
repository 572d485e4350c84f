import { useEffect, useMemo } from "react";
import { useAddress } from "../lib/address";
import { useShared } from "../lib/shared";
import { BENCH } from "./benchLayout";
import { COPIES_KEY, FOUND, type Layout, SAVED_KEY } from "./layout";

/**
 * The layout that is shown. Before `layouts.ts` is there, which finds it: the bench as it comes, unless this browser keeps
 * something else or the address names another one.
 */
export function useLayout(): Layout {
  const { layout: named } = useAddress("layout");
  const found = useShared(FOUND);
  const known = found !== undefined;
  const first = useMemo(
    (): Layout => ({
      id: named || BENCH.id,
      document: BENCH,
      saved: undefined,
      touched: false,
      waiting: !known && (named !== "" || keepsAny()),
      missing: false,
      put: (next, said) => void import("./layouts").then(({ put }) => put(next, said)),
    }),
    [named, known],
  );
  // what leaves the page leaves it to the next visit to find its layout
  useEffect(() => () => FOUND.set(undefined), []);
  return found ?? first;
}

function keepsAny(): boolean {
  try {
    return [COPIES_KEY, SAVED_KEY].some((key) => (localStorage.getItem(key) ?? "{}") !== "{}");
  } catch {
    return false;
  }
}
