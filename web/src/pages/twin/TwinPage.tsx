import { Alert, Button, Group, Loader, Stack, Text } from "@mantine/core";
import { IconCube, IconPlayerStop } from "@tabler/icons-react";
import { useEffect, useRef } from "react";
import type { Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { fixed } from "../../lib/format";
import { NoDevice, Waiting } from "../../lib/NoDevice";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { useScheme } from "../../lib/useScheme";
import { useSelectedAxis } from "../../live/selection";
import { NoWebGl } from "./NoWebGl";
import { stroboscope } from "./numbers";
import { TwinFrame } from "./TwinFrame";
import { TwinNumbers } from "./TwinNumbers";
import classes from "./twin.module.css";
import { othersAxis, type TwinState, useTwin } from "./useTwin";
import { hasWebGl } from "./webgl";

const OFF = "stepscope.twin.off";

/** The selected axis as a motor in 3D. */
export default function TwinPage() {
  const { waiting, device, entry } = useSelectedAxis();
  if (waiting) return <Waiting page="3D" />;
  if (!device || !entry) return <NoDevice page="3D" icon={<IconCube size={22} />} />;
  return <AxisTwin device={device} axis={entry} />;
}

function AxisTwin({ device, axis }: { device: Device; axis: Device["axes"][number] }) {
  const twin = useTwin();
  const scheme = useScheme();
  const { state, show } = twin;
  const wanted = `${device.id}/${axis.index}/${scheme}`;
  const asked = useRef("");
  const known = state !== undefined;
  // Another session may look at another axis: what is theirs is not taken away because this page was opened.
  const others = state !== undefined && othersAxis(state, device.id, axis.index) && asked.current === "";
  const wants = known && !others && sessionStorage.getItem(OFF) === null;

  function start() {
    sessionStorage.removeItem(OFF);
    asked.current = wanted;
    show({ device: device.id, axis: axis.index, scheme });
  }
  // The page itself is the wish to see it; what follows is another axis or another scheme.
  useEffect(() => {
    if (!wants || asked.current === wanted) return;
    asked.current = wanted;
    show({ device: device.id, axis: axis.index, scheme });
  }, [wants, wanted, show, device.id, axis.index, scheme]);

  if (!known && twin.error === null) return <Waiting page="3D" label="Looking for the 3D view" />;
  const label = `3D view of ${device.name}, axis ${axis.name}`;
  const on = state?.state === "on" && !others;
  return (
    <Page name="3D">
      <DeviceNotice device={device} />
      <ProblemAlert error={twin.error} doing="The 3D view" retry={known ? start : twin.again} />
      {!hasWebGl() && <NoWebGl />}
      {others && state && <Theirs state={state} onShow={start} label={`${device.name}, ${axis.name}`} />}
      {state?.state === "failed" && twin.error === null && (
        <ProblemAlert error={state.problem} doing="The 3D view has ended" retry={start} />
      )}
      {on && state.problem !== null && <ProblemAlert error={state.problem} doing={label} />}
      {on ? (
        <div className={`${classes.layout} columns until-62 gap-12`}>
          {hasWebGl() && <TwinFrame state={state} label={label} />}
          <Card
            title={state.recording === null ? axis.name : `Recording ${state.recording}`}
            note={<Updates state={state} />}
            actions={
              <Button
                size="compact-sm"
                variant="default"
                leftSection={<IconPlayerStop size={14} aria-hidden />}
                loading={twin.busy}
                onClick={() => {
                  sessionStorage.setItem(OFF, "1");
                  twin.end();
                }}
              >
                End the view
              </Button>
            }
          >
            <TwinNumbers state={state} />
            <div className="grid gap-8 mt-12">
              {stroboscope(state) !== null && <Text size="sm">{stroboscope(state)}</Text>}
              <Text size="xs" c="dimmed">
                Grey is what this device does not tell. Drag turns the picture, the wheel comes closer. The stage is a
                scheme: it is always drawn as long as what was travelled.
              </Text>
            </div>
          </Card>
        </div>
      ) : twin.busy || state?.state === "starting" ? (
        <Stack align="center" py="xl" gap="xs" role="status">
          <Loader aria-hidden />
          <Text size="sm" c="dimmed">
            Starting the 3D view: a few seconds
          </Text>
        </Stack>
      ) : (
        !others &&
        twin.error === null &&
        state?.state !== "failed" && (
          <EmptyState title="The 3D view is off" icon={<IconCube size={22} />}>
            <Text size="sm" c="dimmed">
              Off it costs nothing. It runs in a process of its own, and ends by itself when nobody looks.
            </Text>
            <Button size="sm" onClick={start} disabled={!known}>
              Show {axis.name} in 3D
            </Button>
          </EmptyState>
        )
      )}
    </Page>
  );
}

/** How many pictures a second, and of how many. */
export function Updates({ state }: { state: TwinState }) {
  const still = state.updates_per_s === 0;
  return (
    <span className="num">
      {still ? "no updates" : `${fixed(state.updates_per_s)} of ${fixed(state.updates_per_s_max)} updates/s`}
    </span>
  );
}

function Theirs({ state, label, onShow }: { state: TwinState; label: string; onShow: () => void }) {
  return (
    <Alert p="sm" role="status" title={`Another session looks at ${state.device}, ${state.name}`}>
      <Group gap="sm">
        <Text size="sm">There is one 3D view for everybody. Showing another axis shows it to them, too.</Text>
        <Button size="compact-sm" onClick={onShow}>
          Show {label}
        </Button>
      </Group>
    </Alert>
  );
}
