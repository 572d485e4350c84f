import { Button, FileButton, Group, NativeSelect, Skeleton, Text, TextInput } from "@mantine/core";
import { useDebouncedValue, useHotkeys } from "@mantine/hooks";
import { IconCamera, IconFileImport, IconFileStack } from "@tabler/icons-react";
import { useRef, useState } from "react";
import { Link } from "wouter";
import type { Problem, Schemas } from "../../api/client";
import { can } from "../../api/queries";
import { Ago } from "../../lib/Ago";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { dateTimeOf } from "../../lib/time";
import { useLocalKept } from "../../lib/useKept";
import { useSelection } from "../../live/selection";
import css from "./profiles.module.css";
import { type Saved, useProfiles, useSave, useTry } from "./useProfiles";

type Order = "newest" | "name" | "device";

/** As the server has them, the newest first; and by what people call them. */
const ORDERS: Record<Order, (all: readonly Saved[]) => readonly Saved[]> = {
  newest: (all) => all,
  name: (all) => [...all].sort((one, other) => one.name.localeCompare(other.name)),
  device: (all) =>
    [...all].sort((one, other) => one.device.localeCompare(other.device) || one.name.localeCompare(other.name)),
};

interface Props {
  selected: number | null;
  onSelect: (id: number) => void;
}

/** All that are kept, and the two ways to get more: from the device, and from a file. */
export function SavedProfiles({ selected, onSelect }: Props) {
  const { device } = useSelection();
  const [search, setSearch] = useState("");
  const [asked] = useDebouncedValue(search.trim(), 150);
  const profiles = useProfiles(asked);
  const save = useSave();
  const tries = useTry();
  const [unreadable, setUnreadable] = useState<Problem | null>(null);
  const again = useRef<() => void>(null);
  const field = useRef<HTMLInputElement>(null);
  useHotkeys([["/", () => field.current?.focus()]]);

  const keep = (body: Schemas["ProfileSave"]) =>
    save.mutate(body, {
      onSuccess: ({ id }) => {
        setSearch("");
        onSelect(id);
      },
    });
  const load = async (file: File | null) => {
    if (file === null) return;
    again.current?.(); // the same file may be chosen again, after the user has mended it
    save.reset();
    setUnreadable(null);
    try {
      keep({ document: JSON.parse(await file.text()) as Schemas["ProfileIn"] });
    } catch (error) {
      setUnreadable(notRead(file.name, error));
    }
  };
  const connected = device?.state === "connected";
  const [order, setOrder] = useLocalKept<Order>("stepscope.profiles.order", "newest");
  const found = ORDERS[order](profiles.data ?? []);
  const none = profiles.isSuccess && found.length === 0;

  return (
    <Card title="Saved profiles" note={profiles.isSuccess && found.length > 0 ? fixed(found.length) : undefined}>
      <Group gap={6} mb={8} wrap="nowrap">
        <Button
          flex={1}
          leftSection={<IconCamera size={15} aria-hidden />}
          disabled={!connected || tries.isPending}
          loading={save.isPending && save.variables?.device !== undefined}
          onClick={() => {
            setUnreadable(null);
            if (device) keep({ device: device.id, name: nameFor(device.name, found) });
          }}
        >
          {device ? `Capture ${device.name}` : "Capture"}
        </Button>
        <FileButton resetRef={again} onChange={(file) => void load(file)} accept=".json,application/json">
          {(props) => (
            <Button {...props} variant="default" leftSection={<IconFileImport size={15} aria-hidden />}>
              Import
            </Button>
          )}
        </FileButton>
      </Group>
      {device?.about.tier === "names" && !can(device, "parameters") && (
        <p className="hint m-0 mb-8">
          Of registers whose access no list tells, a profile has those that were written here and read back.
        </p>
      )}
      {device?.about.tier === "names" && can(device, "parameters") && (
        <div className="mb-8">
          <p className="hint m-0">
            Of its parameters no list tells which can be set. A profile has those that {device.name} was seen to take.
          </p>
          <Button
            size="compact-xs"
            mt={4}
            variant="default"
            disabled={!connected}
            loading={tries.isPending}
            title="Writes each parameter what it holds, once, while the motors stand"
            onClick={() => tries.mutate(device.id)}
          >
            Find out what can be set
          </Button>
          {tries.isError && <ProblemAlert error={tries.error} doing="Trying" onClose={() => tries.reset()} />}
          {tries.isSuccess && tries.variables === device.id && (
            <p className="m-0 mt-4 text-12" role="status">
              <span className="num">{fixed(tries.data.settable)}</span> parameters can be set,{" "}
              <span className="num">{fixed(tries.data.refused.length)}</span> cannot.
            </p>
          )}
        </div>
      )}
      {!connected && (
        <Text className="hint" mb={6}>
          {device ? (
            <>
              {device.name} is {device.state}: its configuration can be captured once it is connected.{" "}
            </>
          ) : (
            <>There is no device to capture. </>
          )}
          <Link href="/connections">Connections</Link>
        </Text>
      )}
      {save.isError && <ProblemAlert error={save.error} doing="Keeping the profile" onClose={() => save.reset()} />}
      {unreadable && <ProblemAlert error={unreadable} doing="Importing" onClose={() => setUnreadable(null)} />}
      <Group gap={6} mb={8} wrap="nowrap">
        <TextInput
          ref={field}
          flex={1}
          type="search"
          aria-label="Search profiles"
          placeholder="name, note, model"
          value={search}
          onChange={(event) => setSearch(event.currentTarget.value)}
        />
        <NativeSelect
          aria-label="Order of the profiles"
          data={[
            { value: "newest", label: "newest first" },
            { value: "name", label: "by name" },
            { value: "device", label: "by device" },
          ]}
          value={order}
          onChange={(event) => setOrder(event.currentTarget.value as Order)}
        />
      </Group>
      {profiles.isError && (
        <ProblemAlert error={profiles.error} doing="Listing profiles" retry={() => void profiles.refetch()} />
      )}
      {profiles.isPending && (
        <div role="status" aria-busy="true" aria-label="Listing profiles">
          <Skeleton height={44} mb={4} radius="sm" />
          <Skeleton height={44} radius="sm" />
        </div>
      )}
      {none &&
        (asked === "" ? (
          <EmptyState title="No profile yet" icon={<IconFileStack size={22} />}>
            <Text size="sm" className="dim">
              A profile is a device's whole configuration: registers, tables, mechanics. Capture one before you change
              something.
            </Text>
          </EmptyState>
        ) : (
          <Text size="sm" className="dim" role="status">
            No profile has all of these words.
          </Text>
        ))}
      {found.length > 0 && (
        <ul className={`${css.saved} list grid gap-4`} aria-label="Profiles">
          {found.map((each) => (
            <li key={each.id}>
              <Entry profile={each} current={each.id === selected} onSelect={() => onSelect(each.id)} />
            </li>
          ))}
        </ul>
      )}
    </Card>
  );
}

function Entry({ profile, current, onSelect }: { profile: Saved; current: boolean; onSelect: () => void }) {
  return (
    <button
      type="button"
      className={`${css.entry} plain lit box pad-s grid gap-2 text-13 w-full`}
      aria-current={current}
      onClick={onSelect}
    >
      <span className="flex between gap-8 bold anywhere">{profile.name}</span>
      <span className="lines-8 hint">
        <span>{profile.title}</span>
        {profile.device !== "" && profile.device !== profile.name && <span>{profile.device}</span>}
        <Ago unixS={profile.created_unix_s} />
      </span>
      {profile.note !== "" && <span className="clip hint">{profile.note}</span>}
    </button>
  );
}

/** When, as people note it beside a measurement. */
export function dateOf(unixS: number): string {
  return dateTimeOf(unixS * 1e3);
}

function notRead(file: string, error: unknown): Problem {
  return {
    type: "/problems/unreadable-file",
    title: "That is no profile",
    status: 0,
    detail: `${file} cannot be read: ${error instanceof Error ? error.message : String(error)}`,
    instance: null,
    way_out: "Choose a file that was exported here, or by `stepscope profile export`.",
    facts: {},
    remedies: [],
  };
}

/** A device's name, numbered where profiles of that name are there already. */
function nameFor(name: string, taken: readonly Saved[]): string {
  const names = new Set(taken.map((each) => each.name));
  let candidate = name;
  for (let number = 2; names.has(candidate); number += 1) candidate = `${name} ${number}`;
  return candidate;
}
