import { Button, Group, Popover, Skeleton, Text, Textarea, TextInput } from "@mantine/core";
import { IconDownload, IconTrash } from "@tabler/icons-react";
import { useState } from "react";
import type { Schemas } from "../../api/client";
import { Card } from "../../lib/Card";
import { fileName, saveText } from "../../lib/files";
import { fixed, frequency } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { Against } from "./Against";
import css from "./profiles.module.css";
import { dateOf } from "./SavedProfiles";
import { ScriptPanel } from "./ScriptPanel";
import { fileOf, useProfile, useRemove, useRename } from "./useProfiles";

/** One profile: what it is, what it would change, and how it is handed on. */
export function ProfileView({ id, onGone }: { id: number; onGone: () => void }) {
  const profile = useProfile(id);
  if (profile.isPending)
    return (
      <div role="status" aria-busy="true" aria-label="Loading the profile" className="grid shrink gap-8">
        <Skeleton height={120} radius="sm" />
        <Skeleton height={260} radius="sm" />
      </div>
    );
  if (profile.isError)
    return (
      <Card title="Profile">
        <ProblemAlert error={profile.error} doing="Opening the profile" retry={() => void profile.refetch()} />
      </Card>
    );
  return (
    <div className="grid shrink gap-8">
      <Head profile={profile.data} onGone={onGone} />
      <Against profile={profile.data} />
      <ScriptPanel profile={profile.data} />
    </div>
  );
}

function Head({ profile, onGone }: { profile: Schemas["ProfileDetail"]; onGone: () => void }) {
  const rename = useRename(profile.id);
  const [failure, setFailure] = useState<unknown>(null);
  const [name, setName] = useState(profile.name);
  const [note, setNote] = useState(profile.note);
  const keepName = () => {
    const wanted = name.trim();
    if (wanted === "") setName(profile.name);
    else if (wanted !== profile.name) rename.mutate({ name: wanted });
  };
  const keepNote = () => {
    if (note !== profile.note) rename.mutate({ note });
  };
  const download = async () => {
    try {
      saveText(fileName(profile.name, ".json"), await fileOf(profile.id), "application/json");
      setFailure(null);
    } catch (error) {
      setFailure(error);
    }
  };
  const { document } = profile;
  return (
    <Card
      title={profile.name}
      note={profile.title}
      actions={
        <>
          <Button
            size="compact-sm"
            variant="default"
            leftSection={<IconDownload size={14} aria-hidden />}
            onClick={() => void download()}
          >
            Export
          </Button>
          <Delete profile={profile} onGone={onGone} />
        </>
      }
    >
      <dl className="facts lines-24 m-0 mb-8 text-13">
        <div>
          <dt>Says</dt>
          <dd>
            <span className="num">{fixed(profile.registers)}</span> registers
          </dd>
        </div>
        {profile.device !== "" && (
          <div>
            <dt>Taken from</dt>
            <dd>{profile.device}</dd>
          </div>
        )}
        <div>
          <dt>Clock</dt>
          <dd className="num">{frequency(document.clock_hz)}</dd>
        </div>
        <div>
          <dt>Kept</dt>
          <dd className="num">{dateOf(profile.created_unix_s)}</dd>
        </div>
      </dl>
      {document.unknown.length > 0 && (
        <Text className="caution text-12" mb={8}>
          It says nothing of {fixed(document.unknown.length)} registers that cannot be read and that nobody had written:{" "}
          {document.unknown
            .slice(0, 6)
            .map((part) => part.name)
            .join(", ")}
          {document.unknown.length > 6 ? ", ..." : ""}.
        </Text>
      )}
      <div className={`${css.names} columns`}>
        <TextInput
          label="Name"
          maxLength={100}
          value={name}
          onChange={(event) => setName(event.currentTarget.value)}
          onBlur={keepName}
          onKeyDown={(event) => event.key === "Enter" && keepName()}
        />
        <Textarea
          size="xs"
          label="Note"
          placeholder="What it is for, what was found"
          autosize
          minRows={1}
          maxRows={6}
          maxLength={10_000}
          value={note}
          onChange={(event) => setNote(event.currentTarget.value)}
          onBlur={keepNote}
        />
      </div>
      {rename.isError && <ProblemAlert error={rename.error} doing="Keeping the words" onClose={() => rename.reset()} />}
      {failure !== null && <ProblemAlert error={failure} doing="Exporting" onClose={() => setFailure(null)} />}
    </Card>
  );
}

/** Deleting asks first. */
function Delete({ profile, onGone }: { profile: Schemas["ProfileDetail"]; onGone: () => void }) {
  const [asking, setAsking] = useState(false);
  const remove = useRemove(profile.id);
  return (
    <Popover opened={asking} onChange={setAsking} width={280} position="bottom-end" withArrow trapFocus shadow="md">
      <Popover.Target>
        <Button
          size="compact-sm"
          variant="default"
          leftSection={<IconTrash size={14} aria-hidden />}
          onClick={() => setAsking(true)}
        >
          Delete
        </Button>
      </Popover.Target>
      <Popover.Dropdown aria-label={`Delete ${profile.name}?`}>
        <Text size="sm" fw={600}>
          Delete {profile.name}?
        </Text>
        <Text size="sm" my={6}>
          It is gone for good. Devices are left as they are.
        </Text>
        {remove.isError && <ProblemAlert error={remove.error} doing="Deleting" />}
        <Group gap="xs" mt="xs">
          <Button
            size="compact-sm"
            loading={remove.isPending}
            onClick={() => remove.mutate(undefined, { onSuccess: onGone })}
          >
            Delete
          </Button>
          <Button size="compact-sm" variant="default" data-autofocus onClick={() => setAsking(false)}>
            Keep
          </Button>
        </Group>
      </Popover.Dropdown>
    </Popover>
  );
}
