import { useEffect, useRef, useState } from "react";
import type { Schemas } from "../../api/client";
import { useFrame } from "../../live/useFrame";
import { EdgeTrail, type SeenEdge } from "./edges";
import type { LiveAxis } from "./live";
import { looksSince } from "./useStage";

const ANSWERED_LATE_S = 1;

/** The edges that the running search has passed, or the last one did; where the server tells of none by itself. */
export function useSearchEdges(
  live: LiveAxis,
  microsteps: number,
  search: Schemas["ReferenceSearchState"] | undefined,
): readonly SeenEdge[] {
  const [trail] = useState(() => new EdgeTrail());
  const [edges, setEdges] = useState<readonly SeenEdge[]>([]);
  const shown = useRef(0);
  const state = search?.state;
  const zero = search?.last_position ?? null;
  const ran = useRef(false);
  useEffect(() => {
    if (state === "running") {
      ran.current = true;
      // the answer that says so is some looks late
      trail.begin((live.source?.buffer.lastTime ?? 0) - ANSWERED_LATE_S);
    } else if (ran.current) {
      ran.current = false;
      if (state === "done" && zero !== null) trail.finish(zero / microsteps);
    }
  }, [trail, state, zero, microsteps, live]);
  useFrame(() => {
    if (state === "running" || trail.finishing)
      for (const look of looksSince(live, microsteps, trail.lookedAtS)) trail.look(look);
    if (shown.current === trail.revision) return;
    shown.current = trail.revision;
    setEdges(trail.edges.slice());
  });
  return edges;
}
