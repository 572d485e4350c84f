import { Button, Popover } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { IconEye, IconLock, IconSteeringWheel } from "@tabler/icons-react";
import { useAccess } from "../../api/access";
import { leaseClient } from "../../api/lease/bench";
import { isFree, type Lease } from "../../api/lease/LeaseClient";
import { later } from "../../lib/later";
import classes from "./lease.module.css";
import { useLease } from "./useLease";
import { isSilent, lasting } from "./words";

const OnlyLooking = later(() => import("./OnlyLooking").then((part) => part.OnlyLooking));
const LeasePanel = later(() => import("./LeasePanel").then((part) => part.LeasePanel));

function takenWords(lease: Lease): string {
  return isSilent(lease)
    ? `${lease.holder} is silent · free in ${lasting(lease.expires_in_s)}`
    : `Taken by ${lease.holder} · ${lasting(lease.since_s)}`;
}

/** The place of the control until it is known who has the bench: nothing in the bar moves then. */
function Room() {
  return (
    <Button variant="default" className={classes.control} style={{ visibility: "hidden" }} aria-hidden tabIndex={-1}>
      <IconSteeringWheel size={16} />
      <span className={classes.words}>You have the bench</span>
    </Button>
  );
}

/** Who has the bench: the way to it, and to everything about it. Without words where there is no room for them. */
export function LeaseControl() {
  const { lease, asking } = useLease();
  const [opened, { toggle, close }] = useDisclosure();
  const access = useAccess();
  if (lease === null) return <Room />;
  if (access?.role === "look") return <OnlyLooking access={access} lease={lease} />;
  if (isFree(lease))
    return (
      <Button
        variant="default"
        className={classes.control}
        data-testid="lease"
        data-lease="free"
        aria-label="The bench is free. Take the bench"
        title="Nobody has the bench: the first change takes it"
        onClick={() => void leaseClient.take()}
      >
        <IconEye size={16} aria-hidden />
        <span className={classes.words}>
          <span className={`${classes.more}  `}>Free · </span>Take the bench
        </span>
      </Button>
    );
  const words = lease.mine ? "You have the bench" : asking ? `Asking ${lease.holder}…` : takenWords(lease);
  const asks = lease.mine ? lease.asking.length : 0;
  const label = asks > 0 ? `${words}, ${asks} ${asks === 1 ? "asks" : "ask"} for it` : words;
  const Icon = lease.mine ? IconSteeringWheel : IconLock;
  return (
    <Popover opened={opened} onChange={(open) => !open && close()} width={300} position="bottom" trapFocus withinPortal>
      <span className="relative">
        <Popover.Target>
          <Button
            variant={lease.mine ? "light" : "default"}
            className={classes.control}
            data-testid="lease"
            data-lease={lease.mine ? "mine" : "taken"}
            aria-label={label}
            title={label}
            onClick={toggle}
          >
            <Icon size={16} aria-hidden />
            <span className={classes.words}>{words}</span>
          </Button>
        </Popover.Target>
        {asks > 0 && (
          <span className={`${classes.asks} absolute text-12 touchless`} aria-hidden>
            {asks}
          </span>
        )}
      </span>
      <Popover.Dropdown p="sm" aria-label="The bench">
        <LeasePanel lease={lease} asking={asking} close={close} />
      </Popover.Dropdown>
    </Popover>
  );
}
