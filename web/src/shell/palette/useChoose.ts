import { useMantineColorScheme } from "@mantine/core";
import { useLocation } from "wouter";
import { minutesAgo, openHistory } from "../../lib/history/aim";
import { useScheme } from "../../lib/useScheme";
import { useSelection } from "../../live/selection";
import { copyLink } from "../CopyLink";
import { redoOne, undoOne } from "../History";
import { stopEverything } from "../stopEverything";
import type { Entry } from "./entries";
import { useRecent } from "./useFound";

const HELP = "/help/";

function openHelp(location: string) {
  window.open(`${HELP}${location}`, "_blank", "noopener");
}

/** Goes where an entry leads, or does what it says, and remembers it. */
export function useChoose(): (entry: Entry) => void {
  const [, go] = useLocation();
  const { select } = useSelection();
  const { setColorScheme } = useMantineColorScheme();
  const scheme = useScheme();
  const [, remember] = useRecent();
  return ({ id, go: target }) => {
    remember(id);
    if ("to" in target) go(target.to);
    else if ("help" in target) openHelp(target.help);
    else if ("device" in target) select(target.device, target.axis);
    else if ("minutesAgo" in target) openHistory(minutesAgo(target.of, target.minutesAgo));
    else if ("panel" in target)
      void import("../../workspace/addPanel").then(({ addPanel }) => addPanel(target.panel, () => go("/")));
    else if (target.act === "undo") undoOne();
    else if (target.act === "redo") redoOne();
    else if (target.act === "history") openHistory();
    else if (target.act === "stop") void stopEverything();
    else if (target.act === "help") openHelp("");
    else if (target.act === "link") void copyLink();
    else setColorScheme(scheme === "light" ? "dark" : "light");
  };
}
