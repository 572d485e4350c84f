import "@mantine/notifications/styles.css";
import { Notifications } from "@mantine/notifications";
import classes from "./shell.module.css";

export function ToastList() {
  return <Notifications position="bottom-right" limit={4} className={classes.toasts ?? ""} />;
}
