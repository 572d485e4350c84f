import {
  Alert,
  Button,
  Code,
  CopyButton,
  Group,
  NativeSelect,
  Table,
  Text,
  TextInput,
  VisuallyHidden,
} from "@mantine/core";
import { IconKey } from "@tabler/icons-react";
import { type FormEvent, useState } from "react";
import { type Access, logOut, useAccess } from "../../api/access";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { Loading } from "../../lib/Loading";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { dateTimeOf } from "../../lib/time";
import classes from "./health.module.css";
import { type Role, useTokenChanges, useTokens } from "./useHealth";

const ROLES: Readonly<Record<Role, string>> = {
  look: "look: reads, and stops motors",
  drive: "drive: everything but tokens",
  administer: "administer: everything",
};

/** Who may come in. Tokens are shown to those alone who administer. */
export function AccessSection() {
  const access = useAccess();
  if (access === null) return null;
  return (
    <Card
      title="Access"
      note={whoWords(access)}
      actions={
        access.by === "session" && (
          <Button size="compact-sm" variant="default" onClick={() => void logOut()}>
            Log out
          </Button>
        )
      }
    >
      {access.role === "administer" ? (
        <Tokens open={access.by === "nothing"} />
      ) : (
        <Text size="sm">Tokens are made and revoked by those who administer this server.</Text>
      )}
    </Card>
  );
}

function whoWords({ by, name, role }: Access): string {
  if (by === "nothing") return "this server asks nobody for a token";
  return name === null ? "you came in with the server's own token" : `you are ${name}, who may ${role}`;
}

function Tokens({ open }: { open: boolean }) {
  const tokens = useTokens(true);
  const { add, revoke } = useTokenChanges();
  return (
    <>
      {open && (
        <Text size="xs" c="dimmed" mb="xs">
          Only this machine reaches the server, so everybody may do everything here. Named tokens count where it listens
          to a network, or is started with --token.
        </Text>
      )}
      <AddForm adding={add.isPending} onAdd={(name, role) => add.mutate({ name, role })} />
      <ProblemAlert error={add.error} doing="Making a token" onClose={() => add.reset()} />
      <ProblemAlert error={revoke.error} doing="Revoking a token" onClose={() => revoke.reset()} />
      {add.data && (
        <Alert
          color="accent"
          mt="xs"
          p="sm"
          role="status"
          icon={<IconKey size={18} aria-hidden />}
          title={`The token of ${add.data.name}, shown this once`}
          withCloseButton
          closeButtonLabel="I have written it down"
          onClose={() => add.reset()}
        >
          <Group gap="sm">
            <Code fz={14} className="anywhere" data-testid="new-token">
              {add.data.token}
            </Code>
            <CopyButton value={add.data.token}>
              {({ copied, copy }) => (
                <Button size="compact-sm" variant="default" onClick={copy}>
                  {copied ? "Copied" : "Copy"}
                </Button>
              )}
            </CopyButton>
          </Group>
        </Alert>
      )}
      {tokens.isError && (
        <ProblemAlert error={tokens.error} doing="Reading the tokens" retry={() => void tokens.refetch()} />
      )}
      {tokens.data === undefined ? (
        tokens.isPending && <Loading size="sm" mt="sm" label="Reading the tokens" />
      ) : tokens.data.length === 0 ? (
        <EmptyState title="No named tokens" icon={<IconKey size={22} />}>
          <Text size="sm">Each gives one person a role, and a name in the lease and the audit log.</Text>
        </EmptyState>
      ) : (
        <Table className={classes.table} mt="sm" verticalSpacing={4} data-testid="tokens">
          <Table.Thead>
            <Table.Tr>
              <Table.Th>Name</Table.Th>
              <Table.Th>Role</Table.Th>
              <Table.Th visibleFrom="sm">Made</Table.Th>
              <Table.Th visibleFrom="sm">Logged in</Table.Th>
              <Table.Th>
                <VisuallyHidden>Revoke</VisuallyHidden>
              </Table.Th>
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody>
            {tokens.data.map((token) => (
              <Table.Tr key={token.name}>
                <Table.Td>{token.name}</Table.Td>
                <Table.Td>{token.role}</Table.Td>
                <Table.Td visibleFrom="sm">{dateTimeOf(token.created_unix_s * 1000)}</Table.Td>
                <Table.Td visibleFrom="sm">{token.sessions}</Table.Td>
                <Table.Td className="right">
                  <Revoke name={token.name} busy={revoke.isPending} onRevoke={() => revoke.mutate(token.name)} />
                </Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      )}
    </>
  );
}

function AddForm({ adding, onAdd }: { adding: boolean; onAdd: (name: string, role: Role) => void }) {
  const [name, setName] = useState("");
  const [role, setRole] = useState<Role>("look");
  const submit = (event: FormEvent) => {
    event.preventDefault();
    if (name.trim() === "") return;
    onAdd(name.trim(), role);
    setName("");
  };
  return (
    <form className="flex wrap end gap-8" onSubmit={submit}>
      <TextInput
        label="Name"
        value={name}
        maxLength={60}
        autoComplete="off"
        onChange={(event) => setName(event.currentTarget.value)}
      />
      <NativeSelect
        label="Role"
        value={role}
        data={Object.entries(ROLES).map(([value, label]) => ({ value, label }))}
        onChange={(event) => setRole(event.currentTarget.value as Role)}
      />
      <Button type="submit" loading={adding} disabled={name.trim() === ""}>
        Make a token
      </Button>
    </form>
  );
}

/** Asks once more in its own place: what is revoked is gone. */
function Revoke({ name, busy, onRevoke }: { name: string; busy: boolean; onRevoke: () => void }) {
  const [sure, setSure] = useState(false);
  return (
    <Button
      size="compact-xs"
      variant={sure ? "filled" : "default"}
      color={sure ? "red" : "gray"}
      aria-label={sure ? `Revoke ${name} now` : `Revoke ${name}`}
      disabled={busy}
      onBlur={() => setSure(false)}
      onClick={() => (sure ? onRevoke() : setSure(true))}
    >
      {sure ? "Revoke now" : "Revoke"}
    </Button>
  );
}
