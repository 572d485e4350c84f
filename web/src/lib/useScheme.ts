import { useComputedColorScheme } from "@mantine/core";

/** The colour scheme in use. */
export function useScheme(): "light" | "dark" {
  return useComputedColorScheme("light", { getInitialValueInEffect: false });
}
