import { Button, Group, Text } from "@mantine/core";
import { IconArrowsExchange } from "@tabler/icons-react";
import type { ReactNode } from "react";
import { Link } from "wouter";
import { useDevices } from "../api/queries";
import { useSelection } from "../live/selection";
import { EmptyState } from "./EmptyState";
import { FAMILY_WORDS, type Family, familyOf } from "./family";

interface Props {
  /** the page's name, as in the navigation */
  page: string;
  /** for whose devices the page is */
  family: Family;
  /** the page that does the same for the other family */
  instead: { href: string; label: string };
  children: ReactNode;
}

/** A page of one family: for a device of the other it says so, with the ways out. Without a device the page decides. */
export function OtherFamily({ page, family, instead, children }: Props) {
  const devices = useDevices();
  const { device, select } = useSelection();
  const own = familyOf(device?.model);
  if (device === undefined || own === null || own === family) return children;
  const fitting = (devices.data ?? []).filter((candidate) => familyOf(candidate.model) === family);
  return (
    <>
      <h1 style={{ fontSize: "1.1rem", margin: 0 }}>{page}</h1>
      <EmptyState title={`${page} is not for ${device.name}`} icon={<IconArrowsExchange size={22} />}>
        <Text size="sm" c="dimmed" maw={440}>
          {device.name} ({device.title}) is {FAMILY_WORDS[own].one} with {FAMILY_WORDS[own].holds}. This page is for{" "}
          {family === "chip" ? "motion controller chips with registers" : "modules with parameters"}.
        </Text>
        <Group gap="xs" justify="center">
          <Button component={Link} href={instead.href} size="sm">
            {instead.label} of {device.name}
          </Button>
          {fitting.slice(0, 3).map((candidate) => (
            <Button key={candidate.id} size="sm" variant="default" onClick={() => select(candidate.id, 0)}>
              {page} of {candidate.name}
            </Button>
          ))}
          {fitting.length === 0 && (
            <Button component={Link} href="/connections" size="sm" variant="default">
              Add {FAMILY_WORDS[family].one}
            </Button>
          )}
        </Group>
      </EmptyState>
    </>
  );
}
