import { Autocomplete, Button, Group, Text } from "@mantine/core";
import { keepPreviousData, useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api } from "../../api/client";
import { compact } from "../../lib/format";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import classes from "./firstRun.module.css";
import type { StepProps } from "./StepProps";
import type { ChosenMotor } from "./steps";
import { Term } from "./Term";

const SHOWN = 20;

/** Which motor it is: of the data base, or as its plate says. */
export function MotorStep({ device, axis, progress, onDone }: StepProps) {
  const queries = useQueryClient();
  const asked = progress.motor;
  const [motor, setMotor] = useState<ChosenMotor>(
    asked ?? {
      name: "",
      ratedCurrentA: 1,
      fullStepsPerRev: axis.full_steps_per_rev,
      senseResistorOhm: axis.limits.sense_resistor_ohm ?? null,
      fullScaleA: axis.limits.current_full_scale_a ?? null,
    },
  );
  const set = (change: Partial<ChosenMotor>) => setMotor((now) => ({ ...now, ...change }));
  const found = useQuery({
    queryKey: ["motors", motor.name],
    queryFn: () => api.GET("/api/v1/motors", { query: { search: motor.name, limit: SHOWN } }),
    placeholderData: keepPreviousData,
    retry: false,
  });
  const known = found.data?.motors.find(({ name }) => name === motor.name);
  const keep = useMutation({
    mutationFn: (own: ChosenMotor) =>
      api.PUT("/api/v1/motors/{motor}", {
        path: { motor: own.name },
        body: { rated_current_a: own.ratedCurrentA, full_steps_per_rev: own.fullStepsPerRev },
      }),
    onSettled: () => queries.invalidateQueries({ queryKey: ["motors"] }),
  });
  const pick = (name: string) => {
    const one = found.data?.motors.find((each) => each.name === name);
    set(
      one === undefined
        ? { name }
        : { name, ratedCurrentA: one.rated_current_a, fullStepsPerRev: one.full_steps_per_rev },
    );
  };
  const scale = device.about.current_scale;
  return (
    <>
      <Text size="sm">
        Find the motor by its name, or put in what its plate says. The <b>rated current</b> is what a coil may carry;
        200 <Term name="full-step">full steps</Term> a turn are 1.8° a step, 400 are 0.9°.
      </Text>
      <div className={classes.fields}>
        <Autocomplete
          label="Motor"
          placeholder="17HS, 42sth48 …"
          data={found.data?.motors.map(({ name }) => name) ?? []}
          filter={({ options }) => options}
          value={motor.name}
          onChange={pick}
          limit={SHOWN}
          maxDropdownHeight={260}
        />
        <NumberField
          label="Rated current"
          unit="A"
          min={0.01}
          max={100}
          step={0.1}
          value={motor.ratedCurrentA}
          onChange={(ratedCurrentA) => set({ ratedCurrentA })}
        />
        <NumberField
          label="Full steps a turn"
          integer
          min={1}
          max={100_000}
          value={motor.fullStepsPerRev}
          onChange={(fullStepsPerRev) => set({ fullStepsPerRev })}
        />
        {scale === "sense_resistor" && (
          <NumberField
            label="Sense resistor"
            unit="Ω"
            min={0.001}
            max={10}
            step={0.01}
            value={motor.senseResistorOhm}
            onChange={(senseResistorOhm) => set({ senseResistorOhm })}
            onClear={() => set({ senseResistorOhm: null })}
          />
        )}
        {scale === "full_scale" && (
          <NumberField
            label="Current at full scale"
            unit="A"
            min={0.01}
            max={100}
            step={0.1}
            value={motor.fullScaleA}
            onChange={(fullScaleA) => set({ fullScaleA })}
            onClear={() => set({ fullScaleA: null })}
          />
        )}
      </div>
      <Group gap="xs" my="sm">
        <Button onClick={() => onDone(motor)}>This is the motor</Button>
        {motor.name.trim() !== "" && !known && (
          <Button variant="default" loading={keep.isPending} onClick={() => keep.mutate(motor)}>
            Keep it as my own motor
          </Button>
        )}
      </Group>
      {!known && found.data && (
        <Text size="sm" className="dim">
          {motor.name.trim() === ""
            ? `The data base knows ${found.data.found} motors.`
            : `${found.data.found} motors of the data base have such a name.`}
        </Text>
      )}
      {known && (
        <Text size="sm" className="dim">
          {[
            known.resistance_ohm !== null && compact(known.resistance_ohm, 3, "Ω"),
            known.inductance_h !== null && compact(known.inductance_h * 1000, 3, "mH"),
            known.holding_torque_nm !== null && `${known.holding_torque_nm} N m`,
          ]
            .filter(Boolean)
            .join(", ")}
          : from {known.source}. Look at the plate: what stands there counts.
        </Text>
      )}
      {scale === "sense_resistor" && motor.senseResistorOhm === null && (
        <Text size="sm" className="dim">
          Without the <Term name="sense-resistor">sense resistor</Term> nobody knows what a current scale is in amperes:
          a cautious one is taken. It stands on the board, R110 is 0.11 Ω.
        </Text>
      )}
      {found.error && (
        <ProblemAlert error={found.error} doing="Looking for motors" retry={() => void found.refetch()} />
      )}
      {keep.error && <ProblemAlert error={keep.error} doing="Keeping the motor" onClose={() => keep.reset()} />}
    </>
  );
}
