import { Button, Group, Text } from "@mantine/core";
import { notifications } from "@mantine/notifications";
import { useEffect, useRef } from "react";
import { leaseClient } from "../../api/lease/bench";
import { useLease } from "./useLease";

const toastOf = (asker: string) => `lease-ask-${asker}`;

/** Says what happens to the bench without this page's doing: another session asks for it, it came, it went. */
export function LeaseNews() {
  const { lease, news } = useLease();
  const shown = useRef(new Set<string>());
  useEffect(() => {
    const asking = new Map(lease?.mine ? lease.asking.map(({ id, name }) => [id, name]) : []);
    for (const [id, name] of asking) {
      if (shown.current.has(id)) continue;
      shown.current.add(id);
      notifications.show({
        id: toastOf(id),
        color: "accent",
        title: `${name} asks for the bench`,
        message: (
          <Group gap="xs" mt={4}>
            <Button size="compact-sm" onClick={() => void leaseClient.handOver(id)}>
              Hand over
            </Button>
            <Text size="xs" c="dimmed">
              What runs goes on.
            </Text>
          </Group>
        ),
        autoClose: false,
        closeButtonProps: { "aria-label": "Not now" },
      });
    }
    for (const id of shown.current) {
      if (asking.has(id)) continue;
      shown.current.delete(id);
      notifications.hide(toastOf(id));
    }
  }, [lease]);
  useEffect(() => {
    if (news === null) return;
    const holder = leaseClient.snapshot.lease?.holder;
    notifications.hide("lease-news");
    notifications.show({
      id: "lease-news",
      color: "gray",
      title: news === "handed" ? "The bench was handed to you" : "You no longer have the bench",
      message:
        news === "handed"
          ? "What you change is done now."
          : holder
            ? `${holder} has it now.`
            : "It is free: given back in another tab, or nothing was heard of this browser for too long.",
      autoClose: news === "handed" ? 4000 : false,
      closeButtonProps: { "aria-label": "Dismiss" },
    });
    leaseClient.dismiss();
  }, [news]);
  return null;
}
