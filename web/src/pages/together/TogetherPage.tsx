import { Text } from "@mantine/core";
import { useDevices } from "../../api/queries";
import { Card } from "../../lib/Card";
import { Loading } from "../../lib/Loading";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { StartCard } from "./StartCard";
import { rowsOf } from "./starts";
import { useWiring } from "./useTogether";
import { WiresCard } from "./WiresCard";

/** Several devices as one machine: axes that start together, and wires between emulated chips. */
export default function TogetherPage() {
  const devices = useDevices();
  const wiring = useWiring();
  if (devices.data === undefined)
    return (
      <Page name="Together">
        <Card aria-label="Together">
          {devices.isError ? (
            <ProblemAlert error={devices.error} doing="Reading the devices" retry={() => void devices.refetch()} />
          ) : (
            <Loading size="sm" label="Loading the devices" />
          )}
        </Card>
      </Page>
    );
  const names = Object.fromEntries(devices.data.map(({ id, name }) => [id, name]));
  return (
    <Page name="Together">
      <StartCard rows={rowsOf(devices.data)} />
      {wiring.isError ? (
        <Card title="Wires">
          <ProblemAlert error={wiring.error} doing="Reading the wires" retry={() => void wiring.refetch()} />
        </Card>
      ) : wiring.data === undefined ? (
        <Card title="Wires">
          <Text size="sm">Reading the wires</Text>
        </Card>
      ) : (
        <WiresCard nets={wiring.data.nets} pins={wiring.data.pins} names={names} />
      )}
    </Page>
  );
}
