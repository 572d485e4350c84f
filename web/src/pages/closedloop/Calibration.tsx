import { Button, Checkbox, Group, Progress, Text } from "@mantine/core";
import { useState } from "react";
import { fixed } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import css from "../../lib/rows/rows.module.css";
import { Section } from "../../lib/Section";
import { degrees } from "./angle";
import classes from "./closedloop.module.css";
import type { Calibrating } from "./useProcedures";

interface Props {
  calibration: Calibrating;
  disabled: boolean;
  /** why it cannot be done now; null where it can */
  why: string | null;
}

/** The chip finds CL_OFFSET: it turns to a full step, and takes the encoder's place there. */
export function Calibration({ calibration, disabled, why }: Props) {
  const [velocity, setVelocity] = useState(10_000);
  const [settleS, setSettleS] = useState(0.1);
  const [switchOn, setSwitchOn] = useState(true);
  const { state, running } = calibration;
  const done = state?.state === "done";
  return (
    <Section title="Calibration" note="finds CL_OFFSET">
      <div className={classes.pair}>
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
        size="xs"
        mt={6}
        label="Leave closed loop on"
        classNames={{ label: css.switchLabel }}
        checked={switchOn}
        disabled={disabled || running}
        onChange={(event) => setSwitchOn(event.currentTarget.checked)}
      />
      <Group gap={6} mt={8} wrap="nowrap">
        <Button
          size="xs"
          disabled={disabled || running || why !== null}
          loading={calibration.starting}
          onClick={() => calibration.start({ velocity_pps: velocity, settle_s: settleS, switch_on: switchOn })}
          data-testid="calibrate"
        >
          Calibrate
        </Button>
        <Button size="xs" variant="default" disabled={!running} onClick={calibration.abort}>
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
            ? "The shaft turns by up to two full steps. No load should pull at it, and the encoder has to count the right way."
            : running
              ? `${state.phase}…`
              : state.message || state.phase)}
      </Text>
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
    </Section>
  );
}
