import { useLocalStorage, useSessionStorage } from "@mantine/hooks";

/** A value that the browser keeps until its tab is closed; known at the first rendering. */
export function useSessionKept<T>(key: string, defaultValue: T) {
  return useSessionStorage<T>({ key, defaultValue, getInitialValueInEffect: false });
}

/** A value that the browser keeps; known at the first rendering. */
export function useLocalKept<T>(key: string, defaultValue: T) {
  return useLocalStorage<T>({ key, defaultValue, getInitialValueInEffect: false });
}
