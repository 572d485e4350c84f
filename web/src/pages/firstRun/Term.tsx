import type { PropsWithChildren } from "react";

/** A word of the field, with its meaning in the glossary of the help. */
export function Term({ name, children }: PropsWithChildren<{ name: string }>) {
  return (
    <a href={`/help/glossary.html#${name}`} target="_blank" rel="noopener" className="ink" title="What this means">
      {children}
    </a>
  );
}
