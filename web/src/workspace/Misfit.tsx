import { Text } from "@mantine/core";
import { IconArrowsExchange } from "@tabler/icons-react";
import { Card } from "../lib/Card";
import { EmptyState } from "../lib/EmptyState";

/** In the place of a panel that has nothing to show here. */
export function Misfit({ title, why }: { title: string; why: string }) {
  return (
    <Card as="div" className="grow">
      <EmptyState title={title} icon={<IconArrowsExchange size={22} />}>
        <Text size="sm" className="dim" maw={360}>
          {why} Its place and settings are kept.
        </Text>
      </EmptyState>
    </Card>
  );
}
