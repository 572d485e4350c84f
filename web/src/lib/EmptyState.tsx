import { Stack, Text } from "@mantine/core";
import type { PropsWithChildren, ReactNode } from "react";

interface Props {
  title: string;
  icon?: ReactNode;
}

/** Nothing here yet: says why, and the children say what to do next (a sentence, then a button or link). */
export function EmptyState({ title, icon, children }: PropsWithChildren<Props>) {
  return (
    <Stack align="center" gap="sm" py="xl" px="md" ta="center" className="dim" role="status">
      {icon && (
        <span className="mark" aria-hidden>
          {icon}
        </span>
      )}
      <Text fw={600} className="ink">
        {title}
      </Text>
      {children}
    </Stack>
  );
}
