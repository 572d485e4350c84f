import { Button, VisuallyHidden } from "@mantine/core";
import { IconHandStop } from "@tabler/icons-react";
import { useQueryClient } from "@tanstack/react-query";
import { useEffect, useState } from "react";
import { conditions } from "../live/conditions";
import { closeWithoutFocus, hasSomethingToClose, shuttleRuns } from "./escape";
import classes from "./shell.module.css";
import { STOP_EVENT, stopEverything } from "./stopEverything";

/**
 * Stops every axis of every device. On the keyboard: Escape, wherever the focus is, while anything moves or nobody
 * knows; while everything stands it only closes what is open.
 */
export function StopAll() {
  const [count, setCount] = useState(0);
  const queries = useQueryClient();

  useEffect(() => {
    // In the capture phase: before anything that Escape closes, which closes all the same.
    function onKey(event: KeyboardEvent) {
      if (event.key !== "Escape" || event.repeat || !event.isTrusted) return;
      if (conditions.mayMove() || shuttleRuns(queries) || !hasSomethingToClose()) void stopEverything();
      closeWithoutFocus();
    }
    // For what says beside a menu what Escape does there (app.css).
    const watch = setInterval(() => {
      document.body.dataset.mayMove = String(conditions.mayMove());
    }, 250);
    const onStop = () => setCount((value) => value + 1);
    window.addEventListener("keydown", onKey, { capture: true });
    window.addEventListener(STOP_EVENT, onStop);
    return () => {
      clearInterval(watch);
      window.removeEventListener("keydown", onKey, { capture: true });
      window.removeEventListener(STOP_EVENT, onStop);
    };
  }, [queries]);

  return (
    <>
      <Button
        size="sm"
        color="red"
        variant="filled"
        className={classes.stop}
        leftSection={<IconHandStop size={18} aria-hidden />}
        rightSection={
          <kbd className={`tag mono ${classes.stopKey}`} aria-hidden>
            Esc
          </kbd>
        }
        onClick={() => void stopEverything()}
        aria-keyshortcuts="Escape"
        data-testid="stop-all"
      >
        STOP<span className={`${classes.stopAllWord}  `}>&nbsp;ALL</span>
      </Button>
      <VisuallyHidden role="alert">
        {count > 0 && <span key={count}>Stop: all axes are told to stop</span>}
      </VisuallyHidden>
    </>
  );
}
