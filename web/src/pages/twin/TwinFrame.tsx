import { Loader, Stack, Text } from "@mantine/core";
import { useElementSize } from "@mantine/hooks";
import { useState } from "react";
import { useScheme } from "../../lib/useScheme";
import { viewOf } from "./camera";
import classes from "./twin.module.css";
import type { TwinState } from "./useTwin";

/** The picture, while the view is on: a page of its own in a frame. */
export function TwinFrame({ state, label }: { state: TwinState; label: string }) {
  const { ref, width, height } = useElementSize();
  const scheme = useScheme();
  const [loaded, setLoaded] = useState("");
  const source = state.path !== null && height > 0 ? viewOf(state.path, scheme, width / height) : null;
  // The address depends on the size: the frame keeps the first one, for another would load the picture anew.
  const [first, setFirst] = useState<{ scheme: string; source: string } | null>(null);
  if (source !== null && first?.scheme !== scheme) setFirst({ scheme, source });
  const shown = first?.source ?? null;
  const waiting = shown === null || loaded !== shown || state.viewers === 0;
  return (
    <div ref={ref} className={`${classes.frame} card relative`} data-waiting={waiting}>
      {shown !== null && (
        <iframe
          key={shown}
          title={label}
          src={shown}
          // It may run its scripts and talk to this server; no pop-ups, no downloads, no leaving this page.
          sandbox="allow-scripts allow-same-origin"
          className={classes.view}
          onLoad={() => setLoaded(shown)}
        />
      )}
      {waiting && (
        <Stack className="cover" align="center" justify="center" gap="xs" role="status">
          <Loader size="sm" aria-hidden />
          <Text size="sm" c="dimmed">
            Loading the 3D view
          </Text>
        </Stack>
      )}
    </div>
  );
}
