import { Autocomplete, Group, Text } from "@mantine/core";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { useEffect } from "react";
import { api } from "../../../api/client";
import { MyMotorsButton } from "../../../lib/motors/MyMotors";
import { useSessionKept } from "../../../lib/useKept";
import { BEGIN, type Progress, progressKey } from "../../firstRun/steps";
import type { FieldsProps } from "../kind";
import { knownOf, type MotorChoice, type NamedMotor } from "./motor";

const SHOWN = 20;

interface Props {
  axis: FieldsProps<never>["axis"];
  choice: MotorChoice;
  /** what it is named for */
  description: string;
  /** what a motor has to tell to be offered */
  usable?: (motor: NamedMotor) => boolean;
  onType: (choice: MotorChoice) => void;
  /** it is found, once; `typed`: here, and not in the first run */
  onMotor: (motor: NamedMotor, choice: MotorChoice, typed: boolean) => void;
  /** what of it is taken as it may not be */
  note?: string;
}

/** A motor of the data base, found as its name is typed; the one of the first run by itself. */
export function MotorField({ axis, choice, description, usable = () => true, onType, onMotor, note = "" }: Props) {
  const [progress] = useSessionKept<Progress>(progressKey(axis.device, axis.index), BEGIN);
  const text = choice.typed ?? progress.motor?.name ?? "";
  const found = useQuery({
    queryKey: ["motors", text],
    queryFn: () => api.GET("/api/v1/motors", { query: { search: text, limit: SHOWN } }),
    placeholderData: keepPreviousData,
    retry: false,
  });
  const motors = found.data?.motors.filter(usable) ?? [];
  const named = motors.find(({ name }) => name === text);
  const lacking = named === undefined && found.data?.motors.some(({ name }) => name === text);
  // however the name came here, and whenever the list that has it: typed, pasted, chosen, or asked in the first run
  const meant = choice.name === text ? undefined : named;
  useEffect(() => {
    if (meant) onMotor(meant, { typed: meant.name, name: meant.name }, choice.typed !== null);
  });
  return (
    <>
      <Group gap={6} wrap="nowrap" align="flex-end">
        <Autocomplete
          className="grow shrink"
          label="Motor"
          description={description}
          placeholder="17HS, 42sth48 …"
          data={motors.map(({ name }) => name)}
          filter={({ options }) => options}
          value={text}
          onChange={(typed) => onType({ typed, name: "" })}
          limit={SHOWN}
          maxDropdownHeight={260}
        />
        <MyMotorsButton
          onUse={(motor) => {
            if (usable(motor)) onMotor(motor, { typed: motor.name, name: motor.name }, true);
            else onType({ typed: motor.name, name: "" });
          }}
        />
      </Group>
      {named && (
        <Text size="sm" className="dim" data-testid="motor">
          {knownOf(named)}
          {note && `. ${note}`}
        </Text>
      )}
      {lacking && (
        <Text size="sm" className="dim" data-testid="motor">
          {text} does not tell the figure that is filled in here: put that into My motors, or below.
        </Text>
      )}
    </>
  );
}
