import { useSyncExternalStore } from "react";
import { conditions, type Standing } from "./conditions";

/** How an axis stands now. */
export function useStanding(device: string, axis: number): Standing {
  return useSyncExternalStore(conditions.subscribe, () => conditions.of(device, axis));
}
