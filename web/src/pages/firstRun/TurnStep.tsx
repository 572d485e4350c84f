import { Button, Group, Text } from "@mantine/core";
import { IconArrowBackUp, IconRotateClockwise2 } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { api } from "../../api/client";
import { motion } from "../../api/motion";
import { ConditionCard } from "../../lib/condition/ConditionCard";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useAction } from "../bench/motion/useAction";
import type { StepProps } from "./StepProps";

/** Fields that turn a motor the other way, where a chip has one. */
const REVERSING = ["shaft", "reverse_motor_dir"];

/** Whether the motor turns, and the way that is called right. */
export function TurnStep({ device, axis, onDone, disabled }: StepProps) {
  const at = { device: device.id, axis: axis.index };
  const action = useAction();
  const [wrong, setWrong] = useState(false);
  const rows = useQuery({
    queryKey: ["registers", device.id, axis.index, "reversing"],
    queryFn: () => api.GET("/api/v1/devices/{device}/registers", { path: { device: device.id } }),
    enabled: !disabled && wrong,
    retry: false,
  });
  const field = rows.data
    ?.filter((row) => row.axis === null || row.axis === axis.index)
    .flatMap(({ fields }) => Object.entries(fields).map(([name, value]) => ({ name, value })))
    .find(({ name }) => REVERSING.includes(name));
  const by = (turns: number) => () =>
    void action.run("Moving", () => motion.move(at, { target: turns, relative: true, unit: "rev" }));
  return (
    <>
      <Text size="sm">
        Look at the shaft from its end. A turn forward should be the way that your machine calls forward.
      </Text>
      <Group gap="xs" my="sm">
        <Button
          leftSection={<IconRotateClockwise2 size={16} aria-hidden />}
          disabled={disabled || action.busy}
          onClick={by(1)}
        >
          One turn forward
        </Button>
        <Button
          variant="default"
          leftSection={<IconArrowBackUp size={16} aria-hidden />}
          disabled={disabled || action.busy}
          onClick={by(-1)}
        >
          One turn back
        </Button>
        <Button variant="light" color="red" disabled={disabled} onClick={() => void motion.stop(at, "ramp")}>
          Stop
        </Button>
      </Group>
      <ConditionCard device={device} axis={axis} nowS={undefined} />
      {action.failure && (
        <ProblemAlert error={action.failure.error} doing={action.failure.doing} onClose={action.dismiss} />
      )}
      <Group gap="xs" mt="sm">
        <Button onClick={() => onDone()}>It turned the right way</Button>
        <Button variant="default" onClick={() => setWrong(true)}>
          It turned the other way
        </Button>
      </Group>
      {wrong &&
        (field ? (
          <Group gap="xs" mt="xs">
            <Text size="sm">
              <code>{field.name}</code> is {field.value}: the other value turns the motor the other way.
            </Text>
            <Button
              size="compact-sm"
              loading={action.busy}
              onClick={() =>
                void action
                  .run("Reversing the motor", () =>
                    api.PUT("/api/v1/devices/{device}/registers/{name}", {
                      path: { device: device.id, name: field.name },
                      query: { axis: axis.index },
                      body: { value: field.value ? 0 : 1 },
                    }),
                  )
                  .then(() => rows.refetch())
              }
            >
              Reverse it
            </Button>
          </Group>
        ) : (
          <Text size="sm" mt="xs" role="status">
            {rows.isLoading
              ? "Looking for a setting that reverses it"
              : "No setting of this device does it: switch the power off, and swap the two wires of one coil."}
          </Text>
        ))}
      {rows.error && (
        <ProblemAlert error={rows.error} doing="Reading the registers" retry={() => void rows.refetch()} />
      )}
      <Text size="sm" className="dim" mt="xs">
        It hums and does not turn: one coil has no contact, or its wires are crossed with the other one's. The condition
        above says so where the driver can tell.
      </Text>
    </>
  );
}
