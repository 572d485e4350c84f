import { ActionIcon, Select } from "@mantine/core";
import { IconPlayerPause, IconPlayerPlay } from "@tabler/icons-react";
import type { PropsWithChildren, ReactNode } from "react";
import { Card } from "../../lib/Card";
import type { LinkState } from "../../live/TelemetrySource";
import { LinkReadout } from "../bench/scope/LinkReadout";
import type { Rolling } from "./useRolling";

interface Props {
  title: string;
  className?: string | undefined;
  rolling: Rolling;
  link: LinkState;
  /** of the device */
  name: string;
  spansS: readonly number[];
  /** before the choice of the time span */
  actions?: ReactNode;
}

/** Plots that follow the newest samples: how long a time they show, whether they run, and how the samples come. */
export function RollingSection(props: PropsWithChildren<Props>) {
  const { title, className, rolling, link, name, spansS, actions, children } = props;
  return (
    <Card
      title={title}
      className={className}
      actions={
        <>
          {actions}
          <Select
            w={80}
            aria-label="Time span"
            data={spansS.map((span) => ({ value: String(span), label: `${span} s` }))}
            value={String(rolling.spanS)}
            onChange={(value) => value && rolling.setSpanS(Number(value))}
          />
          <ActionIcon
            color="accent"
            variant={rolling.paused ? "filled" : "default"}
            size={30}
            aria-label={rolling.paused ? "Run" : "Pause"}
            onClick={() => (rolling.paused ? rolling.run() : rolling.pause())}
          >
            {rolling.paused ? <IconPlayerPlay size={16} /> : <IconPlayerPause size={16} />}
          </ActionIcon>
        </>
      }
    >
      <LinkReadout name={name} several={false} link={link} />
      {children}
    </Card>
  );
}
