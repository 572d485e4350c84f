import { useEffect, useRef } from "react";

/** Calls `draw` in every animation frame for as long as the component lives. `draw` may change without a restart. */
export function useFrame(draw: (nowMs: number) => void): void {
  const latest = useRef(draw);
  latest.current = draw;
  useEffect(() => {
    let request = requestAnimationFrame(function next(now) {
      latest.current(now);
      request = requestAnimationFrame(next);
    });
    return () => cancelAnimationFrame(request);
  }, []);
}
