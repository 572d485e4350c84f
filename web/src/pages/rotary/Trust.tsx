import { Alert, Button, Text } from "@mantine/core";
import { IconAlertTriangle } from "@tabler/icons-react";
import { grouped } from "./exact";
import type { Change, Extended } from "./extended";

interface Props {
  seen: Extended;
  disabled: boolean;
  busy: boolean;
  onChange: (change: Change) => void;
}

/** Why the position is no more than a guess, and what to do about it. Nothing while it is trusted. */
export function Trust({ seen, disabled, busy, onChange }: Props) {
  const { answer, actual } = seen;
  if (!answer.watching || answer.trusted) return null;
  // where the way out is a request of the REST side, the button and the field here are that
  const elsewhere = answer.way_out !== "" && !answer.way_out.includes("PUT");
  return (
    <Alert
      color="orange"
      p="xs"
      icon={<IconAlertTriangle size={20} aria-hidden />}
      title="Where the axis stands is not certain"
      data-testid="untrusted"
    >
      <Text size="sm">{sentence(answer.reason)}</Text>
      <Text size="sm" c="dimmed">
        {elsewhere ? sentence(answer.way_out) : "Confirm what is shown, or say under Set up where it stands."}
      </Text>
      {actual !== null && (
        <Button
          variant="default"
          disabled={disabled}
          loading={busy}
          onClick={() => onChange({ confirm: true })}
          data-testid="confirm"
        >
          It does stand at {grouped(actual)}
        </Button>
      )}
    </Alert>
  );
}

function sentence(text: string): string {
  return text === "" ? "" : `${text.charAt(0).toUpperCase()}${text.slice(1)}.`.replace(/\.\.$/, ".");
}
