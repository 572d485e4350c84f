import { Alert, Text } from "@mantine/core";
import { IconPlugConnectedX } from "@tabler/icons-react";
import { useDevices } from "../api/queries";

/** What is above every page while the server does not answer: what that means, and what to do. */
export function ConnectionBanner() {
  const devices = useDevices();
  if (!devices.isError) return null;
  return (
    <Alert
      color="red"
      role="alert"
      p="sm"
      mb="sm"
      icon={<IconPlugConnectedX size={20} aria-hidden />}
      title="No connection to the stepscope server"
      data-testid="disconnected"
    >
      <Text size="sm">
        What you see is old, and motors cannot be stopped from here: cut their power if you must. Start the server again
        (<code>make run</code> or <code>stepscope serve</code>); this page reconnects by itself.
      </Text>
    </Alert>
  );
}
