import { Anchor, Button, Group, Text, TextInput } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { Link } from "wouter";
import { api } from "../../api/client";
import { can } from "../../api/queries";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useWork } from "../../lib/useWork";
import type { StepProps } from "./StepProps";

/** The setting as a profile, read back from the device. */
export function KeepStep({ device, axis, progress, onDone, disabled }: StepProps) {
  const queries = useQueryClient();
  const [name, setName] = useState(`${device.name}, first run`);
  const motor = progress.motor?.name;
  const save = useWork(
    () =>
      api.POST("/api/v1/profiles", {
        body: { device: device.id, name, note: motor ? `${axis.name}: ${motor}` : `${axis.name} was set up` },
      }),
    { onSuccess: () => onDone(), onSettled: () => queries.invalidateQueries({ queryKey: ["profiles"] }) },
  );
  return (
    <>
      <Text size="sm">
        A profile is all that the device is set to, read from it now. After power-on one click applies it whole.
      </Text>
      <Group gap="xs" align="end" my="sm">
        <TextInput
          label="Name"
          value={name}
          onChange={(event) => setName(event.currentTarget.value)}
          maw={320}
          flex={1}
        />
        <Button disabled={disabled || name.trim() === ""} loading={save.isPending} onClick={save.mutate}>
          Keep the profile
        </Button>
      </Group>
      {save.error && <ProblemAlert error={save.error} doing="Keeping the profile" onClose={save.reset} />}
      {save.data && (
        <>
          <Text size="sm" role="status">
            Kept, with the others on{" "}
            <Anchor component={Link} href="/profiles">
              Profiles
            </Anchor>
            . What may be next:
          </Text>
          <ul className="m-0 text-13 indent" aria-label="What may be next">
            {nextOf(device).map(([href, title, what]) => (
              <li key={href}>
                <Anchor component={Link} href={href} size="sm">
                  {title}
                </Anchor>
                : {what}
              </li>
            ))}
          </ul>
        </>
      )}
    </>
  );
}

/** The pages behind a first run, by what the device can: where, their name, and for what. */
function nextOf(device: StepProps["device"]): [href: string, title: string, what: string][] {
  const pages: [boolean, string, string, string][] = [
    [can(device, "motion"), "/tune", "Tune", "let studies find a faster ramp, or less current, and prove it"],
    [can(device, "closed_loop"), "/closed-loop", "Closed loop", "calibrate it, and see its step response"],
    [can(device, "stallguard"), "/stallguard", "StallGuard", "the load at working speed, and its threshold"],
    [
      can(device, "microsteps.ram") || can(device, "microsteps.mslut"),
      "/microsteps",
      "Microsteps",
      "the table of its current",
    ],
    [can(device, "store"), "/parameters", "Parameters", "store in the EEPROM what shall outlive a power cycle"],
    [true, "/", "Bench", "move it, watch it, record it"],
  ];
  return pages.filter(([shown]) => shown).map(([, ...page]) => page);
}
