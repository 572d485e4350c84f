import { Button, Group, SegmentedControl, Stack, Text } from "@mantine/core";
import { useEffect } from "react";
import { leaseClient } from "../../api/lease/bench";
import type { Asker, Lease, OnVanish } from "../../api/lease/LeaseClient";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { NameField } from "./NameField";
import { useLease } from "./useLease";
import { lasting, ON_VANISH } from "./words";

interface Props {
  lease: Lease;
  asking: boolean;
  close: () => void;
}

/** All about the bench: for who has it what to do with it, for all others how to get it. */
export function LeasePanel({ lease, asking, close }: Props) {
  const { problem } = useLease();
  useEffect(() => () => leaseClient.dismiss(), []);
  return (
    <Stack gap="sm">
      {lease.mine ? <Mine lease={lease} close={close} /> : <Taken lease={lease} asking={asking} />}
      {problem !== null && <ProblemAlert error={problem} onClose={() => leaseClient.dismiss()} />}
    </Stack>
  );
}

function Taken({ lease, asking }: Omit<Props, "close">) {
  return (
    <>
      <Text size="sm">
        <b>{lease.holder}</b> has the bench, for {lasting(lease.since_s)}. You look on; to stop a motor works for
        everybody, always.
      </Text>
      <Text size="xs" c="dimmed">
        Without a sign of {lease.holder} it is free in {lasting(lease.expires_in_s)}.
      </Text>
      <NameField />
      {asking ? (
        <Button variant="default" onClick={() => leaseClient.stopAsking()}>
          Asking {lease.holder}… Do not ask any more
        </Button>
      ) : (
        <Button data-autofocus onClick={() => void leaseClient.ask()}>
          Ask {lease.holder} for it
        </Button>
      )}
    </>
  );
}

function Mine({ lease, close }: { lease: Lease; close: () => void }) {
  const set = (on: OnVanish, afterS: number) => void leaseClient.onVanish(on, afterS);
  return (
    <>
      <Text size="sm">You have the bench, for {lasting(lease.since_s)}. All others look on, and may stop a motor.</Text>
      {lease.asking.map((asker) => (
        <Asking key={asker.id} asker={asker} />
      ))}
      <NameField onSaved={() => void leaseClient.take()} />
      <div>
        <Text size="xs" fw={500} mb={4} id="on-vanish">
          When this page vanishes, motors
        </Text>
        <SegmentedControl
          fullWidth
          aria-labelledby="on-vanish"
          data={Object.entries(ON_VANISH).map(([value, { label }]) => ({ value, label }))}
          value={lease.on_vanish}
          onChange={(value) => set(value as OnVanish, lease.vanish_after_s)}
        />
        <Text size="xs" c="dimmed" mt={4}>
          {ON_VANISH[lease.on_vanish].what}
        </Text>
        <NumberField
          label="after"
          unit="s"
          min={6}
          max={3600}
          step={1}
          mt={6}
          value={lease.vanish_after_s}
          onChange={(value) => set(lease.on_vanish, value)}
        />
      </div>
      <Button
        variant="default"
        onClick={() => {
          close();
          void leaseClient.giveBack();
        }}
      >
        Give the bench back
      </Button>
    </>
  );
}

function Asking({ asker }: { asker: Asker }) {
  return (
    <Group gap="xs" wrap="nowrap" justify="space-between">
      <Text size="sm" truncate>
        <b>{asker.name}</b> asks for it, for {lasting(asker.since_s)}
      </Text>
      <Button size="compact-xs" style={{ flex: "none" }} onClick={() => void leaseClient.handOver(asker.id)}>
        Hand over
      </Button>
    </Group>
  );
}
