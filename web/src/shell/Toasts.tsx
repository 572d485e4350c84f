import { useNotifications } from "@mantine/notifications";
import { useState } from "react";
import { later } from "../lib/later";

const Notifications = later(() => import("./ToastList").then((part) => part.ToastList));

/** Short messages, from the first one on. */
export function Toasts() {
  const [shown, setShown] = useState(false);
  const { notifications } = useNotifications();
  if (notifications.length > 0 && !shown) setShown(true);
  return shown && <Notifications />;
}
