import { Alert, Group, List } from "@mantine/core";
import { IconDatabaseExclamation } from "@tabler/icons-react";
import { Card } from "../../lib/Card";
import { Loading } from "../../lib/Loading";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { AccessSection } from "./AccessSection";
import { DevicesTable } from "./DevicesTable";
import { uptime } from "./figures";
import { Tiles } from "./Tiles";
import { type Health, useHealth } from "./useHealth";

/** How the server is, what its devices' links do, and who may come in. */
export default function HealthPage() {
  const health = useHealth();
  const { data, error, isError } = health;
  return (
    <Page name="Health">
      {isError && <ProblemAlert error={error} doing="Reading the health" retry={() => void health.refetch()} />}
      {data === undefined ? (
        !isError && (
          <Group justify="center" py="xl">
            <Loading label="Reading the health" />
          </Group>
        )
      ) : (
        <>
          <Notes storage={data.storage} />
          <Card title="Server" note={isError ? "old: the server does not answer" : serverWords(data)}>
            <div className="fades" data-testid="health" data-stale={isError}>
              <Tiles health={data} />
            </div>
          </Card>
          <Card title="Devices" note={devicesWords(data)}>
            <div className="fades" data-stale={isError}>
              <DevicesTable devices={data.devices} />
            </div>
          </Card>
        </>
      )}
      <AccessSection />
    </Page>
  );
}

function serverWords(health: Health): string {
  return `stepscope ${health.version}, up for ${uptime(health.uptime_s)}`;
}

function devicesWords({ devices }: Health): string {
  const connected = devices.filter(({ state }) => state === "connected").length;
  const emulated = devices.filter(({ emulator }) => emulator !== null).length;
  return `${connected} of ${devices.length} connected, ${emulated} emulated here`;
}

function Notes({ storage }: { storage: Health["storage"] }) {
  const notes =
    storage.writable === false
      ? [`${storage.data_dir} may not be written: nothing is kept.`, ...storage.notes]
      : storage.notes;
  if (notes.length === 0) return null;
  return (
    <Alert
      color="orange"
      p="sm"
      role="status"
      icon={<IconDatabaseExclamation size={18} aria-hidden />}
      title="Not all is kept, or could be read"
      data-testid="health-notes"
    >
      <List size="sm" spacing={4}>
        {notes.map((note) => (
          <List.Item key={note} style={{ overflowWrap: "anywhere" }}>
            {note}
          </List.Item>
        ))}
      </List>
    </Alert>
  );
}
