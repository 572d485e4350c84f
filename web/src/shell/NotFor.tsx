import { Button, Group, Text } from "@mantine/core";
import { IconArrowsExchange } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { Link } from "wouter";
import { api } from "../api/client";
import { useCatalog, useDevices } from "../api/queries";
import type { PageEntry } from "../families/family";
import { EmptyState } from "../lib/EmptyState";
import { useSelection } from "../live/selection";
import { insteadOf, isFor } from "./pages";

/** That a page is not for the selected device, and where to go from it. */
export function NotFor({ entry }: { entry: PageEntry }) {
  const { label } = entry;
  const devices = useDevices();
  const catalog = useCatalog();
  const titles = useQuery({
    queryKey: ["catalog", "capabilities"],
    queryFn: () => api.GET("/api/v1/catalog/capabilities"),
    staleTime: Number.POSITIVE_INFINITY,
  });
  const { device, select } = useSelection();
  if (device === undefined) return null;
  const fitting = (devices.data ?? []).filter(({ about }) => isFor(entry, about.capabilities));
  const whom = titles.data?.filter(({ name }) => entry.needs.includes(name)).map(({ title }) => title);
  const other = insteadOf(entry, device.about.capabilities);
  const wanted = catalog.data?.find((model) => isFor(entry, model.capabilities));
  return (
    <>
      <h1 style={{ fontSize: "1.1rem", margin: 0 }}>{label}</h1>
      <EmptyState title={`${label} is not for ${device.name}`} icon={<IconArrowsExchange size={22} />}>
        <Text size="sm" c="dimmed" maw={440}>
          {device.name} ({device.title}) is {device.about.description}.
          {whom && ` This page is for ${whom.join(" and ")}.`}
        </Text>
        <Group gap="xs" justify="center">
          {other && (
            <Button component={Link} href={other.path} size="sm">
              {other.label} of {device.name}
            </Button>
          )}
          {fitting.slice(0, 3).map((candidate) => (
            <Button key={candidate.id} size="sm" variant="default" onClick={() => select(candidate.id, 0)}>
              {label} of {candidate.name}
            </Button>
          ))}
          {fitting.length === 0 && wanted && (
            <Button component={Link} href="/connections" size="sm" variant="default">
              Add a {wanted.title}
            </Button>
          )}
        </Group>
      </EmptyState>
    </>
  );
}
