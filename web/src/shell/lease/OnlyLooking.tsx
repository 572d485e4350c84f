import { Button, Popover, Text } from "@mantine/core";
import { IconEye } from "@tabler/icons-react";
import type { Access } from "../../api/access";
import type { Lease } from "../../api/lease/LeaseClient";
import classes from "./lease.module.css";

/** In place of the way to the bench, for a token that may only look. */
export function OnlyLooking({ access, lease }: { access: Access; lease: Lease }) {
  const token = access.name === null ? "Your token" : `Your token, ${access.name},`;
  return (
    <Popover width={280} position="bottom" trapFocus withinPortal>
      <Popover.Target>
        <Button
          variant="default"
          className={classes.control}
          data-testid="lease"
          data-lease="look"
          aria-label="You may only look, and stop"
        >
          <IconEye size={16} aria-hidden />
          <span className={classes.words}>You may only look</span>
        </Button>
      </Popover.Target>
      <Popover.Dropdown p="sm" aria-label="The bench">
        <Text size="sm">
          {token} has the role look: it reads everything, and stops motors. Ask who administers this server for one that
          may drive.
        </Text>
        <Text size="xs" c="dimmed" mt={6}>
          {lease.holder === null ? "Nobody has the bench." : `${lease.holder} has the bench.`}
        </Text>
      </Popover.Dropdown>
    </Popover>
  );
}
