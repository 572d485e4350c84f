import { Button, Select, Skeleton, Text } from "@mantine/core";
import { IconRefresh } from "@tabler/icons-react";
import { useState } from "react";
import type { Schemas } from "../../api/client";
import { type Device, useDevices } from "../../api/queries";
import { Card } from "../../lib/Card";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useSelection } from "../../live/selection";
import { Apply } from "./Apply";
import { DiffTable } from "./DiffTable";
import { useComparison, useDryRun, useProfiles } from "./useProfiles";

type Detail = Schemas["ProfileDetail"];

/** The profile beside a device, with the way to apply it, or beside another profile. */
export function Against({ profile }: { profile: Detail }) {
  const devices = useDevices();
  const selection = useSelection();
  const others = useProfiles("");
  const alike = (devices.data ?? []).filter((device) => device.model === profile.model);
  const here = alike.find((device) => device.id === selection.device?.id) ?? alike[0];
  const siblings = (others.data ?? []).filter((other) => other.model === profile.model && other.id !== profile.id);
  const [chosen, setChosen] = useState<string | null>(null);
  const target = chosen ?? (here ? `device/${here.id}` : null);
  const device = target?.startsWith("device/") ? alike.find(({ id }) => `device/${id}` === target) : undefined;
  const other = target?.startsWith("profile/") ? Number(target.slice("profile/".length)) : null;
  const data = [
    { group: "Devices", items: alike.map(({ id, name }) => ({ value: `device/${id}`, label: name })) },
    { group: "Profiles", items: siblings.map(({ id, name }) => ({ value: `profile/${id}`, label: name })) },
  ].filter(({ items }) => items.length > 0);
  return (
    <Card title="Compare and apply">
      {devices.isError && <ProblemAlert error={devices.error} doing="Looking for devices" />}
      {data.length === 0 ? (
        <Text size="sm" className="dim">
          There is no {profile.title} and no other profile of one to compare it with. Connect one, or add an emulated
          one.
        </Text>
      ) : (
        <div className="flex wrap end gap-8 mb-8">
          <Select
            label="Compare with"
            data={data}
            value={target}
            placeholder="A device or a profile"
            onChange={setChosen}
          />
        </div>
      )}
      {device && <WithDevice key={device.id} profile={profile} device={device} />}
      {other !== null && <WithProfile profile={profile} other={other} />}
    </Card>
  );
}

function WithDevice({ profile, device }: { profile: Detail; device: Device }) {
  const connected = device.state === "connected";
  const dry = useDryRun(device.id, profile.document, connected);
  const away = !connected && (
    <Text size="sm" className="dim" role="status">
      {device.name} is {device.state}: connect it to see what this profile would change.
    </Text>
  );
  // An apply that the device's silence cut off still has to say so: once there is a difference, it stays here.
  if (away && dry.data === undefined) return away;
  if (dry.isPending) return <Comparing />;
  const failed = dry.isError && !away && (
    <ProblemAlert error={dry.error} doing={`Comparing with ${device.name}`} retry={() => void dry.refetch()} />
  );
  if (dry.data === undefined) return away || failed;
  return (
    <>
      {away || failed}
      <Apply key="apply" profile={profile.document} device={device} dry={dry.data} outdated={dry.isError} />
      {failed ? null : (
        <>
          <DiffTable diff={dry.data} profile={profile.document} axisNames={device.axes.map(({ name }) => name)} />
          <Button
            mt={6}
            size="compact-xs"
            variant="subtle"
            leftSection={<IconRefresh size={13} aria-hidden />}
            loading={dry.isFetching}
            onClick={() => void dry.refetch()}
          >
            Compare again
          </Button>
        </>
      )}
    </>
  );
}

function WithProfile({ profile, other }: { profile: Detail; other: number }) {
  const comparison = useComparison(other, profile.id);
  if (comparison.isPending) return <Comparing />;
  if (comparison.isError)
    return <ProblemAlert error={comparison.error} doing="Comparing" retry={() => void comparison.refetch()} />;
  return (
    <DiffTable
      diff={comparison.data}
      profile={profile.document}
      axisNames={profile.document.axes.map(({ name }) => name)}
    />
  );
}

function Comparing() {
  return (
    <div role="status" aria-busy="true" aria-label="Comparing">
      <Skeleton height={26} mb={6} radius="sm" />
      <Skeleton height={160} radius="sm" />
    </div>
  );
}
