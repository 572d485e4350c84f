import { useRef } from "react";
import { later } from "../lib/later";
import { useShared } from "../lib/shared";
import { startUpWanted } from "../lib/startup/wanted";

const StartUpDialog = later(() => import("../lib/startup/StartUpDialog").then((part) => part.StartUpDialog));

/** The place of the start-up dialog: fetched when it is first asked for. */
export function StartUp() {
  const wanted = useShared(startUpWanted) !== null;
  const ever = useRef(false);
  ever.current ||= wanted;
  return ever.current && <StartUpDialog />;
}
