import { Button, Group, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { api } from "../../api/client";
import { can, type Device } from "../../api/queries";
import type { Action } from "../bench/motion/useAction";
import { SWAPPING } from "./flags";
import { type Answer, answerTo, type Side, type Switches } from "./pressed";
import { SettingButton } from "./SettingButton";

const POLL_MS = 150;
const WITHIN_S = 20;

interface Props {
  device: Device;
  axis: number;
  action: Action;
  disabled: boolean;
}

interface Asked {
  side: Side;
  before: Switches;
  untilMs: number;
}

const NAMES: Record<Side, string> = { left: "left", right: "right", home: "home" };

/** Each switch pressed once by hand: whether it is there, and on the side that it is called by. Nothing moves. */
export function PressSwitches({ device, axis, action, disabled }: Props) {
  const [asked, setAsked] = useState<Asked | null>(null);
  const [answer, setAnswer] = useState<Answer | null>(null);
  const read = async () => {
    const { switches } = await api.GET("/api/v1/devices/{device}/axes/{axis}", { path: { device: device.id, axis } });
    return switches;
  };
  useQuery({
    queryKey: ["first-run", "switches", device.id, axis, asked?.side, asked?.untilMs],
    queryFn: async () => {
      const now = await read();
      if (asked) {
        const said = answerTo(asked.side, asked.before, now, performance.now() > asked.untilMs);
        setAnswer(said);
        if (said.kind !== "waiting") setAsked(null);
      }
      return now;
    },
    enabled: asked !== null && !disabled,
    refetchInterval: POLL_MS,
    retry: false,
    gcTime: 0,
  });
  const [pressed, setPressed] = useState<Side>("left");
  const begin = (side: Side) => () =>
    void action.run("Reading the switches", async () => {
      const before = await read();
      setPressed(side);
      setAnswer({ kind: "waiting" });
      setAsked({ side, before, untilMs: performance.now() + WITHIN_S * 1000 });
    });
  const sides: Side[] = can(device, "home_switch") ? ["left", "right", "home"] : ["left", "right"];
  return (
    <div>
      <Group gap="xs">
        {sides.map((side) => (
          <Button key={side} size="compact-sm" variant="default" disabled={disabled} onClick={begin(side)}>
            I press the {NAMES[side]} one
          </Button>
        ))}
      </Group>
      {answer && (
        <Text size="sm" mt="xs" role="status" data-testid="switch-answer" data-kind={answer.kind}>
          {told(answer, NAMES[pressed])}
        </Text>
      )}
      {answer?.kind === "other" && answer.side !== "home" && pressed !== "home" && (
        <SettingButton
          device={device.id}
          axis={axis}
          names={SWAPPING}
          action={action}
          does="the other value lets both change places."
          label="Swap them"
          doing="Swapping the switches"
          otherwise="swap their two plugs."
        />
      )}
    </div>
  );
}

function told(answer: Answer, name: string): string {
  switch (answer.kind) {
    case "waiting":
      return `Press the ${name} switch now, and hold it for half a second.`;
    case "right one":
      return `The ${name} switch is there, and is the ${name} one.`;
    case "other":
      return `You pressed the ${name} one, and the input for ${NAMES[answer.side]} has answered: the two are swapped. Do not move to a switch before that is right.`;
    case "active already":
      return `The ${name} switch is the right one, but it was active until you pressed it: it opens when pressed, or its polarity is set the other way round.`;
    case "none":
      return `No input has answered within ${WITHIN_S} s: it is not connected, or there is none. Without switches, call this place zero.`;
  }
}
