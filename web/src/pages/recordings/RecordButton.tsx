import { ActionIcon, Button, Group, Text } from "@mantine/core";
import { IconPlayerRecord, IconPlayerStop } from "@tabler/icons-react";
import { useState } from "react";
import { Link } from "wouter";
import type { Device } from "../../api/queries";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { LiveText } from "../../live/LiveText";
import { isRunning, useChanges, useRecordings } from "./api";
import { usualChannels } from "./usual";

interface Props {
  device: Device;
  axis: number;
  rateHz: number;
  /** registers or parameters that the plots show too, by name */
  further?: readonly string[];
}

const NONE: readonly string[] = [];

/** Keeps what the plots of an axis show, from now on: beside live plots, one press to begin and one to end. */
export function RecordButton({ device, axis, rateHz, further = NONE }: Props) {
  const list = useRecordings();
  const changes = useChanges();
  const [problem, setProblem] = useState<{ doing: string; error: unknown } | null>(null);
  const [busy, setBusy] = useState(false);
  const running = list.data?.recordings.find((each) => each.device === device.id && isRunning(each));

  async function attempt(doing: string, work: () => Promise<unknown>) {
    setBusy(true);
    setProblem(null);
    try {
      await work();
    } catch (error) {
      setProblem({ doing, error });
    }
    setBusy(false);
  }

  if (problem) return <ProblemAlert {...problem} onClose={() => setProblem(null)} />;
  if (running) {
    const begun = running.started_unix_s ?? 0;
    return (
      <Group gap={4} wrap="nowrap">
        <Button
          variant="light"
          loading={busy}
          leftSection={<IconPlayerStop size={15} aria-hidden />}
          aria-label="End the recording"
          onClick={() => void attempt("Ending the recording", () => changes.stop(running.id))}
        >
          <LiveText read={() => (running.state === "waiting" ? "armed" : elapsed(Date.now() / 1000 - begun))} />
        </Button>
        <Text component={Link} fz={13} c="var(--mantine-color-anchor)" href={`/recordings/${running.id}`}>
          Look
        </Text>
      </Group>
    );
  }
  const channels = usualChannels(device, axis, further);
  const what = device.axes.length === 0 ? "what the scope shows" : "this axis";
  return (
    <ActionIcon
      variant="default"
      size={30}
      loading={busy}
      disabled={device.state !== "connected" || channels.length === 0}
      aria-label={`Record ${what}`}
      title={`Record ${what} from now on`}
      onClick={() =>
        void attempt("Recording", () =>
          changes.start({
            device: device.id,
            channels,
            rate_hz: Math.max(1, Math.min(rateHz, device.rate_max_hz)),
            name: "",
            note: "",
            trigger: { kind: "now" },
          }),
        )
      }
    >
      <IconPlayerRecord size={17} />
    </ActionIcon>
  );
}

function elapsed(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}
