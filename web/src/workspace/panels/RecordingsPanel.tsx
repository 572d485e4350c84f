import { Button, Text } from "@mantine/core";
import { Link } from "wouter";
import { Ago } from "../../lib/Ago";
import { Card } from "../../lib/Card";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { isRunning, type Recording, titleOf, useRecordings } from "../../pages/recordings/api";
import { RecordButton } from "../../pages/recordings/RecordButton";
import classes from "../../pages/recordings/recordings.module.css";
import { stateText } from "../../pages/recordings/words";
import type { DeviceProps } from "../panel";

const SHOWN = 20;
const RATE_HZ = 500;

/** The latest recordings of a device, and the button that begins one. */
export function RecordingsPanel({ device, axis }: DeviceProps) {
  const list = useRecordings();
  const own = (list.data?.recordings ?? []).filter((each) => each.device === device.id);
  const compared = own.filter((each) => !isRunning(each)).slice(0, 2);
  return (
    <Card
      title="Recordings"
      note={device.name}
      className="text-13"
      actions={<RecordButton device={device} axis={axis?.index ?? 0} rateHz={RATE_HZ} />}
    >
      <ProblemAlert error={list.error} doing="Reading the list" retry={() => void list.refetch()} />
      {list.data !== undefined && own.length === 0 && (
        <Text size="sm">No recording of it yet: press Record, and move the motor.</Text>
      )}
      <ul className="list stack gap-4" data-testid="recordings-panel">
        {own.slice(0, SHOWN).map((each) => (
          <Line key={each.id} recording={each} />
        ))}
      </ul>
      {compared.length === 2 && (
        <Button
          component={Link}
          size="compact-sm"
          mt={8}
          variant="default"
          href={`/recordings/compare?of=${compared.map(({ id }) => id).join(",")}`}
        >
          Compare the latest two
        </Button>
      )}
    </Card>
  );
}

function Line({ recording }: { recording: Recording }) {
  return (
    <li className="row wrap gap-8 baseline">
      <Link href={`/recordings/${recording.id}`} className={`${classes.link} anywhere`}>
        {titleOf(recording)}
      </Link>
      <span className="hint">
        {isRunning(recording) ? stateText(recording) : <Ago unixS={recording.started_unix_s ?? 0} />}
      </span>
    </li>
  );
}
