import { Alert, Button, Checkbox, Group, Progress, Text } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api } from "../../../api/client";
import type { AxisAddress } from "../../../api/motion";
import { Card } from "../../../lib/Card";
import { fixed } from "../../../lib/format";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { useWork } from "../../../lib/useWork";
import { degrees } from "./angle";
import type { Calibrating, CalibrationState } from "./useProcedures";

interface Props {
  at: AxisAddress;
  calibration: Calibrating;
  disabled: boolean;
  /** why it cannot be done now; null where it can */
  why: string | null;
  fullStepsPerRev: number;
}

/** How far the motor goes there and back where the encoder turns out to be another one [full steps]. */
const MEASURED_FULL_STEPS = 16;

/** The chip finds CL_OFFSET: it turns to a full step, and takes the encoder's place there. */
export function Calibration({ at, calibration, disabled, why, fullStepsPerRev }: Props) {
  const [velocity, setVelocity] = useState(10_000);
  const [settleS, setSettleS] = useState(0.1);
  const [switchOn, setSwitchOn] = useState(true);
  const { state, running } = calibration;
  const done = state?.state === "done";
  return (
    <Card title="Calibration" note="finds CL_OFFSET">
      <div className="halves end gap-8">
        <NumberField
          label="Speed to the full step"
          unit="pps"
          value={velocity}
          min={1}
          max={1e6}
          step={1000}
          disabled={disabled || running}
          onChange={setVelocity}
        />
        <NumberField
          label="Rest there"
          unit="s"
          value={settleS}
          min={0.01}
          max={10}
          step={0.05}
          disabled={disabled || running}
          onChange={setSettleS}
        />
      </div>
      <Checkbox
        mt={6}
        label="Leave closed loop on"
        classNames={{ label: "text-12" }}
        checked={switchOn}
        disabled={disabled || running}
        onChange={(event) => setSwitchOn(event.currentTarget.checked)}
      />
      <Text size="xs" mt={6} data-testid="calibration-way">
        The shaft turns by two full steps; by {MEASURED_FULL_STEPS} there and back (
        {fixed((MEASURED_FULL_STEPS * 360) / fullStepsPerRev, 1)}°) where the encoder is another than is set. No load
        should pull at it.
      </Text>
      <Group gap={6} mt={8} wrap="nowrap">
        <Button
          disabled={disabled || running || why !== null}
          loading={calibration.starting}
          onClick={() => calibration.start({ velocity_pps: velocity, settle_s: settleS, switch_on: switchOn })}
          data-testid="calibrate"
        >
          Calibrate
        </Button>
        <Button variant="default" disabled={!running} onClick={calibration.abort}>
          Abort
        </Button>
      </Group>
      <Progress
        value={100 * (running || done ? (state?.progress ?? 0) : 0)}
        size="sm"
        mt={8}
        aria-label="Progress of the calibration"
      />
      <Text
        size="xs"
        c="dimmed"
        mt={4}
        mih={34}
        role="status"
        data-testid="calibration-state"
        data-state={state?.state ?? "unknown"}
      >
        {why ??
          (state === undefined || state.state === "idle"
            ? ""
            : running
              ? `${state.phase}…`
              : state.message || state.phase)}
      </Text>
      {state?.state === "failed" && state.encoder && (
        <EncoderOffer key={state.message} at={at} found={state.encoder} disabled={disabled} />
      )}
      {state?.offset !== null && state?.offset !== undefined && (
        <Text size="sm" data-testid="calibration-offset">
          CL_OFFSET {state.offset_before !== null && `${fixed(state.offset_before)} → `}
          <b>{fixed(state.offset)}</b>{" "}
          <Text span size="xs" c="dimmed">
            {fixed(degrees(((state.offset % 1024) + 1024) % 1024), 1)}° of the electrical turn
          </Text>
        </Text>
      )}
      {calibration.error && (
        <ProblemAlert error={calibration.error} doing="Calibrating" onClose={calibration.dismiss} />
      )}
    </Card>
  );
}

interface OfferProps {
  at: AxisAddress;
  found: NonNullable<CalibrationState["encoder"]>;
  disabled: boolean;
}

/** The encoder that a move has shown instead of the one that is set, and the writes that put it right. */
function EncoderOffer({ at, found, disabled }: OfferProps) {
  const queries = useQueryClient();
  const writes = Object.entries(found.writes);
  const write = useWork(
    async () => {
      for (const [name, fields] of writes)
        await api.PUT("/api/v1/devices/{device}/registers/{name}", {
          path: { device: at.device, name },
          query: { axis: at.axis },
          body: { fields },
        });
    },
    { onSettled: () => queries.invalidateQueries() },
  );
  const counts = found.writes.ENC_IN_RES?.ENC_IN_RES;
  const words = [
    ...(counts === undefined ? [] : [`${fixed(counts)} counts a turn`]),
    ...(found.writes.ENC_IN_CONF === undefined ? [] : ["the other direction"]),
  ].join(", ");
  return (
    <Alert color="orange" p="xs" mt={4} data-testid="encoder-offer">
      <Text size="sm">
        Measured: <b>{fixed(found.counts_per_turn)}</b> ± {fixed(found.uncertainty)} counts a turn. Set:{" "}
        {fixed(found.set_counts)}.
      </Text>
      {writes.length === 0 ? (
        <Text size="sm">No usual encoder has that many: look at its data sheet, and at its wires.</Text>
      ) : write.isSuccess ? (
        <Text size="sm">Written: {words}. Calibrate again.</Text>
      ) : (
        <Button disabled={disabled} loading={write.isPending} onClick={() => write.mutate()}>
          Write {words}
        </Button>
      )}
      {write.error && <ProblemAlert error={write.error} doing="Writing the resolution" onClose={write.reset} />}
    </Alert>
  );
}
