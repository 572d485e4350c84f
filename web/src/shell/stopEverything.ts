import { notifications } from "@mantine/notifications";
import { api, problemOf } from "../api/client";
import { STOP_EVENT } from "../api/lease/bench";

export { STOP_EVENT };

const TOAST = "stop-all";

/** Says that everything is to stop: held jog buttons let go, and what watches for it reacts at once. */
function tellThePage() {
  window.dispatchEvent(new Event(STOP_EVENT));
}

function show(toast: Parameters<typeof notifications.show>[0]) {
  // one toast for all stops: pressing Escape five times is one message
  notifications.hide(TOAST);
  notifications.show({ ...toast, id: TOAST });
}

/** Stops every axis of every device and says how it went. Never throws. */
export async function stopEverything(): Promise<void> {
  tellThePage();
  try {
    const report = await api.POST("/api/v1/stop", { body: { mode: "ramp" } });
    const failed = report.results.filter((result) => !result.ok);
    if (failed.length > 0) {
      show({
        color: "red",
        title: "Some axes did not confirm the stop",
        message: failed
          .map((result) => `${result.device} axis ${result.axis}: ${result.problem?.detail ?? "no answer"}`)
          .join("\n"),
        autoClose: false,
      });
      return;
    }
    const count = report.results.length;
    show({
      color: "gray",
      title: "Stopped",
      message:
        count === 0 ? "No axis is connected" : `${count} ${count === 1 ? "axis slows" : "axes slow"} down and stop`,
      autoClose: 2500,
    });
  } catch (error) {
    const problem = problemOf(error);
    show({
      color: "red",
      title: `Stop failed: ${problem.title}`,
      message: `${problem.detail}. If a motor moves, cut its power.`,
      autoClose: false,
    });
  }
}
