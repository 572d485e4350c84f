import { Button, Text } from "@mantine/core";
import { IconEye } from "@tabler/icons-react";
import { useMutation } from "@tanstack/react-query";
import { api } from "../../api/client";
import type { Device } from "../../api/queries";
import { hex } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { type RegisterRow, summary } from "../../lib/rows/bits";
import { timeOf } from "../../lib/time";

/** Of a register that a read clears: one read, for a user who has asked for it and was told what it costs. */
export function ReadOnce({ device, row }: { device: Device | undefined; row: RegisterRow }) {
  const look = useMutation({
    mutationFn: async () => {
      const path = { device: device?.id ?? "", name: row.name };
      const reading = await api.GET("/api/v1/devices/{device}/registers/{name}", { path, query: { axis: row.axis } });
      return { raw: reading.raw, at: timeOf(Date.now()) };
    },
  });
  return (
    <div className={`stack start gap-4 mt-4`}>
      <Button
        size="compact-xs"
        variant="default"
        leftSection={<IconEye size={13} aria-hidden />}
        disabled={device?.state !== "connected"}
        loading={look.isPending}
        onClick={() => look.mutate()}
      >
        Read it once, and clear it
      </Button>
      {look.data && (
        <Text size="xs" role="status">
          At {look.data.at} it was <span className="num">{hex(look.data.raw, row.width)}</span>:{" "}
          {summary(row, look.data.raw)}
        </Text>
      )}
      {look.isError && <ProblemAlert error={look.error} doing={`Reading ${row.name}`} onClose={() => look.reset()} />}
    </div>
  );
}
