import { AppShell, Burger, Group, NavLink, ScrollArea, Text } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import {
  IconActivity,
  IconBinaryTree,
  IconChartLine,
  IconPlugConnected,
  IconTableColumn,
  IconWaveSine,
} from "@tabler/icons-react";
import type { PropsWithChildren } from "react";
import { Link, useLocation } from "wouter";
import { ColorSchemeToggle } from "./ColorSchemeToggle";
import { DevicePicker } from "./DevicePicker";
import { StopAll } from "./StopAll";

const PAGES = [
  { path: "/", label: "Bench", Icon: IconActivity },
  { path: "/registers", label: "Registers", Icon: IconTableColumn },
  { path: "/ramps", label: "Ramps", Icon: IconChartLine },
  { path: "/microsteps", label: "Microsteps", Icon: IconWaveSine },
  { path: "/chain", label: "Driver chain", Icon: IconBinaryTree },
  { path: "/connections", label: "Connections", Icon: IconPlugConnected },
] as const;

/** The frame of every page: pages on the left, the selected axis above, stop always in reach. */
export function Shell({ children }: PropsWithChildren) {
  const [opened, { toggle, close }] = useDisclosure();
  const [location] = useLocation();
  return (
    <AppShell
      header={{ height: 52 }}
      navbar={{ width: 188, breakpoint: "sm", collapsed: { mobile: !opened } }}
      padding={{ base: "xs", sm: "md" }}
    >
      <AppShell.Header>
        <Group h="100%" px="sm" gap="sm" wrap="nowrap" justify="space-between">
          <Group gap="xs" wrap="nowrap">
            <Burger opened={opened} onClick={toggle} hiddenFrom="sm" size="sm" aria-label="Pages" />
            <img src="/favicon.svg" width={24} height={24} alt="" />
            <Text fw={700} visibleFrom="sm" component="span">
              stepscope
            </Text>
          </Group>
          <DevicePicker />
          <Group gap="xs" wrap="nowrap">
            <ColorSchemeToggle />
            <StopAll />
          </Group>
        </Group>
      </AppShell.Header>
      <AppShell.Navbar p="xs">
        <ScrollArea>
          {PAGES.map(({ path, label, Icon }) => (
            <NavLink
              key={path}
              component={Link}
              href={path}
              label={label}
              active={location === path}
              leftSection={<Icon size={18} stroke={1.6} aria-hidden />}
              onClick={close}
            />
          ))}
        </ScrollArea>
      </AppShell.Navbar>
      <AppShell.Main>{children}</AppShell.Main>
    </AppShell>
  );
}
