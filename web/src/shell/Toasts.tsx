import { Notification, Portal } from "@mantine/core";
import { type NotificationData, notifications, useNotifications } from "@mantine/notifications";
import { useEffect } from "react";
import classes from "./shell.module.css";

const CLOSE_AFTER_MS = 4000;

/**
 * Short messages. In the first load, without the library's moving list of them: what says that a stop has failed cannot
 * be fetched when the server is away.
 */
export function Toasts() {
  const { notifications: shown } = useNotifications();
  return (
    <Portal>
      <div className={`${classes.toasts} stack gap-8`}>
        {shown.map((toast) => (
          <Toast key={toast.id} toast={toast} />
        ))}
      </div>
    </Portal>
  );
}

function Toast({ toast }: { toast: NotificationData }) {
  const { id = "", message, autoClose = true, color = "gray", title, closeButtonProps } = toast;
  const afterMs = typeof autoClose === "number" ? autoClose : autoClose ? CLOSE_AFTER_MS : null;
  useEffect(() => {
    if (afterMs === null) return;
    const timer = window.setTimeout(() => notifications.hide(id), afterMs);
    return () => window.clearTimeout(timer);
  }, [id, afterMs]);
  return (
    <Notification
      color={color}
      title={title}
      closeButtonProps={{ "aria-label": "Dismiss", ...closeButtonProps }}
      onClose={() => notifications.hide(id)}
      styles={{ description: { color: "var(--mantine-color-text)" } }} // the library's grey is too faint
      withBorder
    >
      {message}
    </Notification>
  );
}
