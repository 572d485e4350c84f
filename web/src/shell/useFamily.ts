import { useSessionStorage } from "@mantine/hooks";
import { useEffect } from "react";
import { useDevices } from "../api/queries";
import { type Family, familyOf } from "../lib/family";
import { useSelection } from "../live/selection";

/** The family of the selected device; until the devices are known, that of the last look: the menu does not jump. */
export function useFamily(): Family | null {
  const devices = useDevices();
  const { device } = useSelection();
  const [kept, keep] = useSessionStorage<Family | null>({
    key: "stepscope.family",
    defaultValue: null,
    getInitialValueInEffect: false,
  });
  const known = devices.data !== undefined;
  const family = known ? familyOf(device?.model) : kept;
  useEffect(() => {
    if (known) keep(family);
  }, [known, family, keep]);
  return family;
}
