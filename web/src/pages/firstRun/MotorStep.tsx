import { Autocomplete, Button, Group, Text } from "@mantine/core";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { useEffect, useState } from "react";
import { api, type Schemas } from "../../api/client";
import { FurtherFields } from "../../lib/motors/FurtherFields";
import {
  alike,
  draftOf,
  figuresOf,
  figuresText,
  type MotorDraft,
  NOT_KNOWN,
  nameProblem,
} from "../../lib/motors/figures";
import { MyMotorsButton } from "../../lib/motors/MyMotors";
import { useKeepMotor } from "../../lib/motors/useOwnMotors";
import { useRefused } from "../../lib/motors/useRefused";
import { NumberField } from "../../lib/NumberField";
import { ProblemAlert } from "../../lib/ProblemAlert";
import classes from "./firstRun.module.css";
import type { StepProps } from "./StepProps";
import type { ChosenMotor } from "./steps";
import { Term } from "./Term";

const SHOWN = 20;

/** Which motor it is: of the data base, or as its plate says. */
export function MotorStep({ device, axis, progress, onDone }: StepProps) {
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
  const [filled, setFilled] = useState(motor.name);
  const fill = (one: Schemas["MotorInfo"]) => {
    const { name, rated_current_a, full_steps_per_rev, ...further } = draftOf(one);
    setFilled(name);
    set({ name, ratedCurrentA: one.rated_current_a, fullStepsPerRev: full_steps_per_rev, further });
  };
  // picked, or typed before the list had it
  const meant = known?.name === filled ? undefined : known;
  useEffect(() => {
    if (meant) fill(meant);
  });
  // what was filled in of one motor is not kept unseen with the name of another
  const called = (name: string) => {
    if (known) setFilled("");
    set(known ? { name, further: NOT_KNOWN } : { name });
  };
  const keep = useKeepMotor();
  const refused = useRefused();
  const further = motor.further ?? NOT_KNOWN;
  const draft: MotorDraft = {
    name: motor.name.trim(),
    rated_current_a: motor.ratedCurrentA,
    full_steps_per_rev: motor.fullStepsPerRev,
    ...further,
  };
  const isNew = draft.name !== "" && known === undefined && found.data !== undefined && !found.isPlaceholderData;
  const differs = known !== undefined && meant === undefined && !alike(draftOf(known), draft);
  const wrongName = isNew ? nameProblem(draft.name) : undefined;
  const keepIt = () => {
    const figures = figuresOf(draft);
    if (figures === null) return;
    setFilled(draft.name);
    set({ name: draft.name });
    keep.mutate({ name: draft.name, figures });
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
          error={wrongName}
          onChange={called}
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
          onWrong={refused.onWrong("ratedCurrentA")}
        />
        <NumberField
          label="Full steps a turn"
          integer
          min={1}
          max={100_000}
          value={motor.fullStepsPerRev}
          onChange={(fullStepsPerRev) => set({ fullStepsPerRev })}
          onWrong={refused.onWrong("fullStepsPerRev")}
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
      <details>
        <summary className="text-13">More of its data sheet, to keep it as your own</summary>
        <div className={classes.fields}>
          <FurtherFields
            figures={further}
            set={(change) => set({ further: { ...further, ...change } })}
            onWrong={refused.onWrong}
          />
        </div>
      </details>
      <Group gap="xs" my="sm">
        <Button onClick={() => onDone(motor)}>This is the motor</Button>
        {(isNew || differs) && (
          <Button
            variant="default"
            loading={keep.isPending}
            disabled={refused.any || wrongName !== undefined}
            onClick={keepIt}
          >
            {known?.own ? "Keep what I changed of my motor" : "Keep it as my own motor"}
          </Button>
        )}
        <MyMotorsButton onUse={fill} />
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
          {figuresText(known)}: {known.own ? known.source : `from ${known.source}`}. Look at the plate: what stands
          there counts.
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
