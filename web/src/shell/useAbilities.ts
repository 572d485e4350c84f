import { useEffect } from "react";
import { useDevices } from "../api/queries";
import { useSessionKept } from "../lib/useKept";
import { useSelection } from "../live/selection";
import type { Abilities } from "./pages";

/** What the selected device can; until the devices are known, as at the last look: the menu does not jump. */
export function useAbilities(): Abilities | null {
  const devices = useDevices();
  const { device } = useSelection();
  const [kept, keep] = useSessionKept<Abilities | null>("stepscope.abilities", null);
  const known = devices.data !== undefined;
  const abilities = known ? (device?.about.capabilities ?? null) : kept;
  useEffect(() => {
    if (known) keep(abilities);
  }, [known, abilities, keep]);
  return abilities;
}
