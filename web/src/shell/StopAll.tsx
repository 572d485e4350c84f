import { Button, Kbd, VisuallyHidden } from "@mantine/core";
import { IconHandStop } from "@tabler/icons-react";
import { useEffect, useState } from "react";
import classes from "./shell.module.css";
import { STOP_EVENT, stopEverything } from "./stopEverything";

/** Stops every axis of every device. On the keyboard: Escape, wherever the focus is. */
export function StopAll() {
  const [count, setCount] = useState(0);

  useEffect(() => {
    // In the capture phase and without regard to who else handles it: Escape also closes menus, and still stops.
    function onKey(event: KeyboardEvent) {
      if (event.key === "Escape" && !event.repeat) void stopEverything();
    }
    const onStop = () => setCount((value) => value + 1);
    window.addEventListener("keydown", onKey, { capture: true });
    window.addEventListener(STOP_EVENT, onStop);
    return () => {
      window.removeEventListener("keydown", onKey, { capture: true });
      window.removeEventListener(STOP_EVENT, onStop);
    };
  }, []);

  return (
    <>
      <Button
        color="red"
        variant="filled"
        className={classes.stop}
        leftSection={<IconHandStop size={18} aria-hidden />}
        rightSection={
          <Kbd visibleFrom="md" className={classes.stopKey} aria-hidden>
            Esc
          </Kbd>
        }
        onClick={() => void stopEverything()}
        aria-keyshortcuts="Escape"
        data-testid="stop-all"
      >
        STOP<span className={classes.stopAllWord}>&nbsp;ALL</span>
      </Button>
      <VisuallyHidden role="alert">
        {count > 0 && <span key={count}>Stop: all axes are told to stop</span>}
      </VisuallyHidden>
    </>
  );
}
