import { useSyncExternalStore } from "react";
import { desk } from "../../api/lease/bench";

export function useLease() {
  return useSyncExternalStore(desk.subscribe, () => desk.snapshot);
}
