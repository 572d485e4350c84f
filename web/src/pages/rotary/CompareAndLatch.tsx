import { Button, Text } from "@mantine/core";
import { useMutation } from "@tanstack/react-query";
import { api } from "../../api/client";
import type { AxisAddress } from "../../api/motion";
import type { Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { CompareEvent } from "./CompareEvent";
import { ExactField, whole } from "./ExactField";
import { grouped, LEAST, MOST, wholeOf } from "./exact";
import { type Change, type Extended, LATCHED_ROUTE } from "./extended";

interface Props {
  device: Device;
  at: AxisAddress;
  seen: Extended;
  /** the chip has a compare register */
  compares: boolean;
  disabled: boolean;
  busy: boolean;
  onChange: (change: Change) => void;
}

/** Where the chip tells that the axis comes by, and where a switch latched it, both beyond the counter. */
export function CompareAndLatch({ device, at, seen, compares, disabled, busy, onChange }: Props) {
  const { compare, latch_register: latch } = seen.answer;
  const latched = useMutation({ mutationFn: () => api.GET(LATCHED_ROUTE, { path: at }) });
  const position = wholeOf(compare?.position_text);
  if (!compares && latch === null) return null;
  return (
    <Card title={compares && latch !== null ? "Compare and latch" : compares ? "Compare" : "Latch"}>
      {compares && (
        <div className="flex end gap-6">
          <ExactField
            flex={1}
            label="Tell when it passes"
            unit="µsteps"
            value={position === null ? "" : grouped(position)}
            placeholder="no position"
            disabled={disabled || busy}
            check={whole(LEAST, MOST, "Within 64 bits")}
            onValue={({ n }) => onChange({ compare: n.toString() })}
            data-testid="compare"
          />
          <Button
            flex="none"
            variant="default"
            disabled={disabled || busy || compare === null}
            onClick={() => onChange({ compare: null })}
            data-testid="compare-off"
          >
            Let go
          </Button>
        </div>
      )}
      {compare !== null && (
        <Text size="xs" c="dimmed" mt={4} data-testid="compare-state">
          {compare.armed
            ? `${compare.register_name} holds it: its output tells`
            : `${compare.register_name} waits: the axis is further away than the counter can tell apart`}
        </Text>
      )}
      {compares && <CompareEvent device={device} axis={at.axis} disabled={device.state !== "connected"} />}
      {latch !== null && (
        <div className="lines-4 baseline mt-8 text-12">
          <Text component="span" size="xs" c="dimmed">
            {latch}
          </Text>
          <span className="num" data-testid="latched">
            {latched.data ? grouped(BigInt(latched.data.position_text)) : "not read yet"}
          </span>
          <Button
            size="compact-xs"
            ml="auto"
            variant="default"
            disabled={disabled}
            loading={latched.isPending}
            onClick={() => latched.mutate()}
            data-testid="read-latched"
          >
            Read
          </Button>
        </div>
      )}
      {latched.isError && (
        <ProblemAlert error={latched.error} doing="Reading what was latched" onClose={latched.reset} />
      )}
    </Card>
  );
}
