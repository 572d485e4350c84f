import { ActionIcon } from "@mantine/core";
import { notifications } from "@mantine/notifications";
import { IconArrowBackUpDouble } from "@tabler/icons-react";
import { useEffect, useState } from "react";
import { api } from "../api/client";
import { type Aim, changeText, onOpenHistory, openHistory, withoutChange } from "../lib/history/aim";
import { redo, undo } from "../lib/history/history";
import { later } from "../lib/later";

const HistoryDrawer = later(() => import("./HistoryDrawer").then((part) => part.HistoryDrawer));
const TOAST = "history";
const NO_TEXT = new Set(["checkbox", "radio", "range", "button", "submit", "color", "file"]);

/** Whether Ctrl Z belongs to what has the focus: a text that is being written. */
function isText(target: EventTarget | null): boolean {
  if (target instanceof HTMLInputElement) return !NO_TEXT.has(target.type) && !target.readOnly;
  return target instanceof HTMLTextAreaElement || (target instanceof HTMLElement && target.isContentEditable);
}

function tell(done: string, what: string | null): void {
  notifications.hide(TOAST);
  const message =
    what === null ? `Nothing to ${done === "Undone" ? "undo" : "redo"} on this page.` : `${done}: ${what}`;
  notifications.show({ id: TOAST, message, autoClose: 2500 });
}

export const undoOne = (): void => tell("Undone", undo());
export const redoOne = (): void => tell("Redone", redo());

/** The latest change of a device that wrote something; null where the server knows of none. */
async function latestOf(device: string): Promise<Aim | null> {
  const answer = api.GET("/api/v1/devices/{device}/history", { path: { device }, query: { limit: 20 } });
  const { changes } = await answer.catch(() => ({ changes: [] }));
  const latest = changes.find(({ writes }) => writes > 0);
  return latest ? withoutChange(device, latest.last, changeText(latest)) : null;
}

/** What was done, in a drawer; Ctrl Z and Ctrl Shift Z take back and do again, but in a text that is being written. */
export function History() {
  const [wanted, setWanted] = useState(false);
  const [opened, setOpened] = useState(false);
  const [aim, setAim] = useState<Aim | null>(null);
  useEffect(
    () =>
      onOpenHistory((at) => {
        const show = (asked: Aim | null) => {
          setAim(asked);
          setWanted(true);
          setOpened(true);
        };
        if (at !== null && "latest" in at) void latestOf(at.latest).then(show);
        else show(at);
      }),
    [],
  );
  useEffect(() => {
    const pressed = (event: KeyboardEvent) => {
      const key = event.key.toLowerCase();
      if (!(event.ctrlKey || event.metaKey) || event.altKey || (key !== "z" && key !== "y")) return;
      if (event.defaultPrevented || isText(event.target)) return;
      event.preventDefault();
      if (key === "z" && !event.shiftKey) undoOne();
      else redoOne();
    };
    window.addEventListener("keydown", pressed);
    return () => window.removeEventListener("keydown", pressed);
  }, []);
  return (
    <>
      <ActionIcon
        aria-label="History"
        title="History: undo what was designed, staged or written (Ctrl Z)"
        onClick={() => openHistory()}
        visibleFrom="sm"
      >
        <IconArrowBackUpDouble size={18} />
      </ActionIcon>
      {wanted && <HistoryDrawer opened={opened} close={() => setOpened(false)} aim={aim} />}
    </>
  );
}
