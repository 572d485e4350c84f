import { VisuallyHidden } from "@mantine/core";
import type { PropsWithChildren } from "react";

/** A page of cards, with its name for those who do not see the navigation. */
export function Page({ name, children }: PropsWithChildren<{ name: string }>) {
  return (
    <div className="grid shrink gap-8">
      <VisuallyHidden>
        <h1>{name}</h1>
      </VisuallyHidden>
      {children}
    </div>
  );
}
