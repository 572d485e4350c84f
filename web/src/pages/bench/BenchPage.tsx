import { Button, Text, VisuallyHidden } from "@mantine/core";
import { IconPlugConnected } from "@tabler/icons-react";
import { type CSSProperties, useEffect } from "react";
import { Link } from "wouter";
import { useDevices } from "../../api/queries";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { Workspace } from "../../workspace/Workspace";
import css from "../../workspace/workspace.module.css";
import classes from "./bench.module.css";
import { BenchLive } from "./live";
import { putSettings, useScopeSettings } from "./scope/settings";

/** The workspace: by default all axes at a glance, one in the hand, and the scope on it. */
export default function BenchPage() {
  const devices = useDevices();
  const [settings] = useScopeSettings();
  const known = devices.data !== undefined;
  // biome-ignore lint/correctness/useExhaustiveDependencies: as it was left; each change of it says so by itself
  useEffect(() => {
    if (known) putSettings(settings);
  }, [known]);
  if (devices.data === undefined) return devices.isError ? null : <Skeleton />;
  if (devices.data.length === 0)
    return (
      <EmptyState title="No device yet" icon={<IconPlugConnected size={22} />}>
        <Text size="sm">Add a chip on a TCP link, or an emulated one.</Text>
        <Button component={Link} href="/connections" size="sm">
          Add a device
        </Button>
      </EmptyState>
    );
  return (
    <BenchLive>
      <VisuallyHidden>
        <h1>Bench</h1>
      </VisuallyHidden>
      <Workspace devices={devices.data} lost={devices.isError} />
    </BenchLive>
  );
}

/** The bench's boxes while nobody knows yet what is in them: each already where it will be. */
function Skeleton() {
  return (
    <div className={css.root} role="status" aria-label="Looking for devices">
      <div className={css.part} data-shape="col" data-moves style={{ "--flex": "0 0 300px" } as CSSProperties}>
        <Card as="div" className={classes.card} data-skeleton />
        <Card as="div" className={classes.tree} data-skeleton />
      </div>
      <div className={css.part} data-shape="col" style={{ "--flex": "1 1 0" } as CSSProperties}>
        <Card as="div" className={classes.stageBox} data-skeleton />
        <Card as="div" className={`${classes.scopeSkeleton} grow`} />
      </div>
    </div>
  );
}
