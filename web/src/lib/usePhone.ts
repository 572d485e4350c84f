import { useMediaQuery } from "@mantine/hooks";

const NARROW = "(max-width: 48em)";

/** Whether the screen is as narrow as a phone's, from the first rendering on. */
export function usePhone(): boolean {
  return useMediaQuery(NARROW, window.matchMedia(NARROW).matches) ?? false;
}
