import { useRef, useState } from "react";

/** Functions that stay the same and call the latest ones: who has been given them need not be drawn anew. */
export function useLatest<T extends Record<string, (...given: never[]) => unknown>>(now: T): T {
  const latest = useRef(now);
  latest.current = now;
  const [steady] = useState(
    () =>
      Object.fromEntries(
        Object.keys(now).map((name) => [name, (...given: never[]) => latest.current[name]?.(...given)]),
      ) as T,
  );
  return steady;
}
