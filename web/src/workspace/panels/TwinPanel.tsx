import { Button, Text } from "@mantine/core";
import { IconCube } from "@tabler/icons-react";
import { type CSSProperties, useEffect, useRef } from "react";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useScheme } from "../../lib/useScheme";
import { NoWebGl } from "../../pages/twin/NoWebGl";
import { TwinFrame } from "../../pages/twin/TwinFrame";
import { othersAxis, useTwin } from "../../pages/twin/useTwin";
import { hasWebGl } from "../../pages/twin/webgl";
import type { PanelProps } from "../panel";

const WHOLE = { "--frame-height": "100%", display: "grid", flex: 1, minHeight: 260 } as CSSProperties;

/** The axis in 3D. What another session looks at is not taken away before somebody asks for it. */
export function TwinPanel({ device, axis }: PanelProps) {
  const { state, error, busy, show, again } = useTwin();
  const scheme = useScheme();
  const wanted = `${device.id}/${axis.index}/${scheme}`;
  const asked = useRef("");
  const known = state !== undefined;
  const others = known && asked.current === "" && othersAxis(state, device.id, axis.index);
  const start = () => {
    asked.current = wanted;
    show({ device: device.id, axis: axis.index, scheme });
  };
  const wants = known && !others && hasWebGl();
  useEffect(() => {
    if (!wants || asked.current === wanted) return;
    asked.current = wanted;
    show({ device: device.id, axis: axis.index, scheme });
  }, [wants, wanted, show, device.id, axis.index, scheme]);
  if (!hasWebGl()) return <NoWebGl />;
  if (error !== null) return <ProblemAlert error={error} doing="The 3D view" retry={known ? start : again} />;
  if (state?.state === "on" && !others)
    return (
      <div style={WHOLE}>
        <TwinFrame state={state} label={`3D view of ${device.name}, axis ${axis.name}`} />
      </div>
    );
  return (
    <Card as="div" className="grow">
      <EmptyState
        title={others ? `Another session looks at ${state.name}` : "The 3D view"}
        icon={<IconCube size={22} />}
      >
        {others || state?.state === "off" || state?.state === "failed" ? (
          <Button size="sm" onClick={start} loading={busy}>
            Show {axis.name} in 3D
          </Button>
        ) : (
          <Text size="sm" className="dim">
            Starting: a few seconds
          </Text>
        )}
      </EmptyState>
    </Card>
  );
}
