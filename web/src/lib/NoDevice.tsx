import { Button, Stack, Text } from "@mantine/core";
import type { ReactNode } from "react";
import { Link } from "wouter";
import { EmptyState } from "./EmptyState";
import { Loading } from "./Loading";
import { Page } from "./Page";

interface Props {
  icon: ReactNode;
  title?: string;
  /** what a device for the page is: "a device with an encoder" */
  wanted?: string;
  /** the page that shows nothing else; none: it stands on one */
  page?: string;
}

/** Nothing to show, and where devices are added. */
export function NoDevice({ icon, title = "No device", wanted = "a device", page }: Props) {
  const empty = (
    <EmptyState title={title} icon={icon}>
      <Text size="sm" className="dim">
        Connect {wanted}, or add an emulated one: that needs no hardware.
      </Text>
      <Button component={Link} href="/connections" size="sm">
        Add a device
      </Button>
    </EmptyState>
  );
  return page === undefined ? empty : <Page name={page}>{empty}</Page>;
}

/** A page of which nothing is known yet. */
export function Waiting({ page, label = "Looking for devices" }: { page: string; label?: string }) {
  return (
    <Page name={page}>
      <Stack align="center" py="xl">
        <Loading label={label} />
      </Stack>
    </Page>
  );
}
