import { useSyncExternalStore } from "react";
import { leaseClient } from "../../api/lease/bench";

export function useLease() {
  return useSyncExternalStore(leaseClient.subscribe, () => leaseClient.snapshot);
}
