import { Loader, type LoaderProps } from "@mantine/core";

/** What is waited for, as a ring that turns, and in words for those who do not see it. */
export function Loading({ label, ...props }: LoaderProps & { label: string }) {
  return <Loader {...props} role="progressbar" aria-label={label} />;
}
