import { Anchor, Button, Group, Text, TextInput } from "@mantine/core";
import { useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { Link } from "wouter";
import { api } from "../../api/client";
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
        <Text size="sm" role="status">
          Kept. Next: design a faster ramp, or let{" "}
          <Anchor component={Link} href="/tune">
            Tune
          </Anchor>{" "}
          find one; all profiles are on{" "}
          <Anchor component={Link} href="/profiles">
            Profiles
          </Anchor>
          .
        </Text>
      )}
    </>
  );
}
