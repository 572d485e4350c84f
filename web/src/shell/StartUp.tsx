import { useSyncExternalStore } from "react";
import { later } from "../lib/later";
import { everWantedStartUp, onWantedStartUp } from "../lib/startup/wanted";

const StartUpDialog = later(() => import("../lib/startup/StartUpDialog").then((part) => part.StartUpDialog));

/** The place of the start-up dialog: fetched when it is first asked for. */
export function StartUp() {
  return useSyncExternalStore(onWantedStartUp, everWantedStartUp) && <StartUpDialog />;
}
