import { Button, Group, Text } from "@mantine/core";
import { IconArrowsExchange } from "@tabler/icons-react";
import type { ReactNode } from "react";
import { Link } from "wouter";
import { useDevices } from "../api/queries";
import { useSelection } from "../live/selection";
import { EmptyState } from "./EmptyState";
import { type Family, familyOf, wordsFor, wordsOf } from "./family";

interface Props {
  /** the page's name, as in the navigation */
  page: string;
  /** for whose devices the page is; of none: for all */
  families: readonly Family[];
  /** the page that does the same for a device of another family */
  instead: (family: Family) => { href: string; label: string };
  children: ReactNode;
}

/** A page of some families: for a device of another it says so, with the ways out. Without a device the page decides. */
export function OtherFamily({ page, families, instead, children }: Props) {
  const devices = useDevices();
  const { device, select } = useSelection();
  const own = familyOf(device?.model);
  if (device === undefined || own === null || families.length === 0 || families.includes(own)) return children;
  const fits = (model: string) => families.some((family) => familyOf(model) === family);
  const fitting = (devices.data ?? []).filter((candidate) => fits(candidate.model));
  const other = instead(own);
  return (
    <>
      <h1 style={{ fontSize: "1.1rem", margin: 0 }}>{page}</h1>
      <EmptyState title={`${page} is not for ${device.name}`} icon={<IconArrowsExchange size={22} />}>
        <Text size="sm" c="dimmed" maw={440}>
          {device.name} ({device.title}) is {wordsOf(own).one}. This page is for {wordsFor(families)}.
        </Text>
        <Group gap="xs" justify="center">
          <Button component={Link} href={other.href} size="sm">
            {other.label} of {device.name}
          </Button>
          {fitting.slice(0, 3).map((candidate) => (
            <Button key={candidate.id} size="sm" variant="default" onClick={() => select(candidate.id, 0)}>
              {page} of {candidate.name}
            </Button>
          ))}
          {fitting.length === 0 && families[0] && (
            <Button component={Link} href="/connections" size="sm" variant="default">
              Add {wordsOf(families[0]).add}
            </Button>
          )}
        </Group>
      </EmptyState>
    </>
  );
}
