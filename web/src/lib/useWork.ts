import { type UseMutationOptions, type UseMutationResult, useMutation } from "@tanstack/react-query";

type Options<T> = Omit<UseMutationOptions<T, Error, () => Promise<T>>, "mutationFn">;

export type Work<T> = Omit<UseMutationResult<T, Error, () => Promise<T>>, "mutate" | "mutateAsync"> & {
  mutate: () => void;
};

/**
 * A mutation that does the `work` of the render whose button was pressed. With a bare `useMutation` it is that of
 * whatever render comes before the work begins, a moment later: what goes to a motor would not be what was shown.
 */
export function useWork<T>(work: () => Promise<T>, options?: Options<T>): Work<T> {
  const mutation = useMutation({ ...options, mutationFn: (pressed: () => Promise<T>) => pressed() });
  return { ...mutation, mutate: () => mutation.mutate(work) };
}
