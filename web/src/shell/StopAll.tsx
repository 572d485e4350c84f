import { Button, Kbd } from "@mantine/core";
import { useHotkeys } from "@mantine/hooks";
import { notifications } from "@mantine/notifications";
import { IconHandStop } from "@tabler/icons-react";
import { useCallback } from "react";
import { api, problemOf, unwrap } from "../api/client";

/** Stops every axis of every device. On the keyboard: Escape, or Space outside of controls. */
export function StopAll() {
  const stop = useCallback(async () => {
    try {
      const report = unwrap(await api.POST("/api/v1/stop", { body: { mode: "ramp" } }));
      const failed = report.results.filter((result) => !result.ok);
      if (failed.length > 0) {
        notifications.show({
          color: "red",
          title: "Some axes did not confirm the stop",
          message: failed
            .map((result) => `${result.device} axis ${result.axis}: ${result.problem?.detail ?? "no answer"}`)
            .join("\n"),
          autoClose: false,
        });
      } else {
        notifications.show({
          color: "gray",
          title: "Stopped",
          message: `${report.results.length} axes slow down and stop`,
          autoClose: 2500,
        });
      }
    } catch (error) {
      const problem = problemOf(error);
      notifications.show({
        color: "red",
        title: `Stop failed: ${problem.title}`,
        message: problem.detail,
        autoClose: false,
      });
    }
  }, []);
  useHotkeys([["Escape", () => void stop()]], []);
  return (
    <Button
      color="red"
      variant="filled"
      leftSection={<IconHandStop size={18} aria-hidden />}
      rightSection={<Kbd visibleFrom="sm">Esc</Kbd>}
      onClick={() => void stop()}
      data-testid="stop-all"
    >
      STOP ALL
    </Button>
  );
}
