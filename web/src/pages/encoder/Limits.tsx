import { Button, Group, Text } from "@mantine/core";
import { useState } from "react";
import { ApiError } from "../../api/client";
import { Card } from "../../lib/Card";
import { compact } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useAction } from "../bench/motion/useAction";
import { StagedBar } from "../module/StagedBar";
import type { Parameters } from "../module/useParameters";
import { LIMIT, RESOLUTION } from "./settings";
import { ENCODERS, type Which } from "./useEncoder";

const ALIAS: Record<Which, string> = { internal: "AP 212", external: "AP 218" };
const MOST = 2 ** 31 - 1;

interface Props {
  parameters: Parameters;
  shown: readonly Which[];
  microstepsPerTurn: number;
  disabled: boolean;
}

/** From which deviation on the module stops the motor. */
export function Limits({ parameters, shown, microstepsPerTurn, disabled }: Props) {
  return (
    <Card title="Deviation limit" note="0 is off">
      {shown.map((which) => {
        const planned = parameters.planned(LIMIT[which]);
        const staged = parameters.staged.has(LIMIT[which]);
        return (
          <NumberField
            key={which}
            label={`${ENCODERS[which].label}, ${ALIAS[which]}${staged ? " ·" : ""}`}
            unit="microsteps"
            integer
            min={0}
            max={MOST}
            step={10}
            value={planned}
            placeholder="unknown"
            description={
              planned === null
                ? "not read yet"
                : planned === 0
                  ? "never stops the motor"
                  : `${compact((planned / microstepsPerTurn) * 360)}° of the shaft`
            }
            inputWrapperOrder={["label", "input", "description", "error"]}
            disabled={disabled}
            onChange={(value) => parameters.stage(LIMIT[which], value)}
            data-testid={`limit-${which}`}
          />
        );
      })}
      {shown.includes("external") && (
        <NumberField
          label="External counts a turn, AP 217"
          integer
          min={0}
          max={1_000_000}
          value={parameters.planned(RESOLUTION)}
          placeholder="unknown"
          description="lines × 4"
          inputWrapperOrder={["label", "input", "description", "error"]}
          disabled={disabled}
          onChange={(value) => parameters.stage(RESOLUTION, value)}
        />
      )}
      <StagedBar parameters={parameters} disabled={disabled} />
    </Card>
  );
}

interface CounterProps {
  /** the counter's name at the device */
  alias: string;
  /** what sets it */
  write: (value: number) => Promise<unknown>;
  /** live: the counter of the motor, and whether it moves; NaN while unknown */
  actual: () => number;
  moving: () => boolean;
  onSet: () => void;
  disabled: boolean;
}

/** The encoder's counter set anew: to the motor's, or to a number. */
export function Counter({ alias, write, actual, moving, onSet, disabled }: CounterProps) {
  const [value, setValue] = useState(0);
  const action = useAction();
  const set = (to: () => number) =>
    void action
      .run("Setting the encoder", async () => {
        const target = to();
        if (moving() || Number.isNaN(target))
          throw new ApiError({
            type: "/problems/wrong-state",
            title: moving() ? "The axis moves" : "The position is unknown",
            status: 409,
            detail: "The encoder can be set while the axis stands still and its position is known.",
            way_out: moving() ? "Stop it first." : "Wait for samples, or set a number.",
            facts: {},
            remedies: [],
            instance: null,
          });
        await write(Math.round(target));
      })
      .then((done) => done && onSet());
  return (
    <Card title="Set encoder" note={alias}>
      <div className="my-8 row between gap-8">
        <NumberField
          aria-label="Encoder position to set"
          unit="microsteps"
          integer
          value={value}
          min={-(2 ** 31)}
          max={2 ** 31 - 1}
          disabled={disabled}
          onChange={setValue}
          flex={1}
        />
        <Button variant="default" disabled={disabled} onClick={() => set(() => value)}>
          Set
        </Button>
      </div>
      <Group mt={6} gap={6} wrap="nowrap" justify="space-between">
        <Button
          variant="default"
          disabled={disabled}
          onClick={() => set(actual)}
          title="The deviation becomes 0"
          data-testid="encoder-to-actual"
        >
          To the actual position
        </Button>
      </Group>
      <Text size="xs" c="dimmed" mt={4}>
        The motor does not move. What was gathered over the turn is cleared.
      </Text>
      {action.failure && (
        <ProblemAlert error={action.failure.error} doing={action.failure.doing} onClose={action.dismiss} />
      )}
    </Card>
  );
}
