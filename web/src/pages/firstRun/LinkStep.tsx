import { Anchor, Button, Group, Progress, Text } from "@mantine/core";
import { useState } from "react";
import { Link } from "wouter";
import { duration, fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useWork } from "../../lib/useWork";
import { useLinkInfo } from "../../lib/wire/useLinkInfo";
import { FRAMES, type LinkFigures, tryLink } from "./linkTrial";
import type { StepProps } from "./StepProps";

/** What is at the other end of the wire, and whether the wire is good. */
export function LinkStep({ device, onDone, disabled }: StepProps) {
  const [share, setShare] = useState(0);
  const link = useLinkInfo(device);
  const trial = useWork(() => tryLink(device.id, setShare), { onMutate: () => setShare(0) });
  const inside = link.data?.kind === "emulator";
  return (
    <>
      <Text size="sm">
        At the other end answers a <b>{device.about.title}</b>
        {inside ? ", emulated in this server" : link.data ? `, through ${link.data.name}` : ""}. Is it another one, or
        at another port? Look on <ToConnections />: it searches ports, and recognises what answers there.
      </Text>
      <Text size="sm" className="dim" mt={4}>
        {fixed(FRAMES)} frames show whether the wire is good: all registers are read, again and again, for 10 s at most.
      </Text>
      <Group gap="xs" my="sm">
        <Button
          variant={trial.data ? "default" : "filled"}
          disabled={disabled}
          loading={trial.isPending}
          onClick={trial.mutate}
        >
          Try the wire
        </Button>
        <Button variant={trial.data ? "filled" : "default"} onClick={() => onDone()}>
          Go on
        </Button>
      </Group>
      {trial.isPending && (
        <Progress value={share * 100} size="sm" aria-label={`${fixed(share * 100)} % of the frames sent`} />
      )}
      {trial.error && <ProblemAlert error={trial.error} doing="Trying the wire" onClose={trial.reset} />}
      {trial.data && <Told figures={trial.data} />}
    </>
  );
}

function Told({ figures: { sent, lost, medianMs, p99Ms } }: { figures: LinkFigures }) {
  return (
    <Text size="sm" role="status" data-testid="link-trial" {...(lost > 0 ? { c: "red" } : {})}>
      {fixed(sent)} frames, {lost === 0 ? "none" : fixed(lost)} lost
      {medianMs !== null && p99Ms !== null
        ? `; half of the answers came within ${duration(medianMs / 1000)}, 99 of 100 within ${duration(p99Ms / 1000)}`
        : ""}
      .{lost > 0 && " Look at cable, ground and speed of the wire before a motor turns; the Console shows each frame."}
    </Text>
  );
}

function ToConnections() {
  return (
    <Anchor component={Link} href="/connections">
      Connections
    </Anchor>
  );
}
