import { Button, Text } from "@mantine/core";
import { IconCube } from "@tabler/icons-react";
import { useQueryClient } from "@tanstack/react-query";
import { useEffect, useState } from "react";
import { api } from "../../api/client";
import { Card } from "../../lib/Card";
import { recordingCursor } from "../../lib/cursor";
import { fixed } from "../../lib/format";
import { Loading } from "../../lib/Loading";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useScheme } from "../../lib/useScheme";
import { NoWebGl } from "./NoWebGl";
import { Scrubber } from "./Scrubber";
import { TwinFrame } from "./TwinFrame";
import { TwinNumbers } from "./TwinNumbers";
import classes from "./twin.module.css";
import { TWIN_KEY, useTwin } from "./useTwin";
import { hasWebGl } from "./webgl";

/** A recording's axis in 3D, where the plot's cursor stands. Off until it is switched on. */
export function RecordingTwin({ recording }: { recording: string }) {
  const [open, setOpen] = useState(false);
  return (
    <Card
      title="3D"
      note={open ? "at the cursor of the plot" : undefined}
      actions={
        <Button
          size="compact-sm"
          variant="default"
          leftSection={<IconCube size={14} aria-hidden />}
          aria-expanded={open}
          onClick={() => setOpen(!open)}
        >
          {open ? "End the view" : "Show in 3D"}
        </Button>
      }
    >
      {open && <Scrubbed recording={recording} />}
    </Card>
  );
}

function Scrubbed({ recording }: { recording: string }) {
  const twin = useTwin();
  const queries = useQueryClient();
  const scheme = useScheme();
  const [problem, setProblem] = useState<unknown>(null);
  const [attempt, setAttempt] = useState(0);

  // biome-ignore lint/correctness/useExhaustiveDependencies: another attempt begins anew
  useEffect(() => {
    const scrubber = new Scrubber(
      async (place) => {
        const body = { ...place, scheme };
        queries.setQueryData(TWIN_KEY, await api.POST("/api/v1/twin/cursor", { body }));
        setProblem(null);
      },
      (error) => setProblem(error),
    );
    const follow = () => {
      const at = recordingCursor.get();
      scrubber.to(at?.recording === recording ? at : { recording, time_s: 0 });
    };
    follow();
    const unsubscribe = recordingCursor.subscribe(follow);
    return () => {
      unsubscribe();
      scrubber.end();
      // what the axis does now again, or nothing where nothing was shown before
      void api.POST("/api/v1/twin/cursor", { body: { recording: null } }).catch(() => undefined);
    };
  }, [recording, scheme, queries, attempt]);

  const state = twin.state;
  const ours = state?.state === "on" && state.recording === recording;
  const failed = problem ?? (state?.state === "failed" ? state.problem : null);
  return (
    <>
      <ProblemAlert error={failed} doing="The 3D view" retry={() => setAttempt(attempt + 1)} />
      {!hasWebGl() && <NoWebGl />}
      {!ours && failed === null && <Loading size="sm" label="Starting the 3D view" />}
      {ours && (
        <div className={`${classes.scrubbed} columns until-62 gap-12`}>
          {hasWebGl() && <TwinFrame state={state} label="3D view of the recording, at the cursor of its plot" />}
          <div>
            <Text size="sm" className="num">
              at {fixed(state.recording_time_s, 3, "s")}
            </Text>
            <TwinNumbers state={state} />
          </div>
        </div>
      )}
    </>
  );
}
