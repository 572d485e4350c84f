import { Text } from "@mantine/core";
import type { Schemas } from "../../api/client";
import { EmulatorTime, Faults, Power } from "../../pages/bench/EmulatorParts";
import type { ControlsProps } from "../family";

type ListedState = Schemas["ListedState"];
type ListedPatch = Schemas["ListedPatch"];

const FAULTS = [
  ["silence", "Silent: answers are lost"],
  ["unplugged", "Unplugged: the line is gone"],
] as const;

/** What there is of a plain emulated module: its time, its line and its power. */
export function Controls({ ...emulator }: ControlsProps) {
  const state = emulator.state as ListedState;
  const send: (patch: ListedPatch) => void = emulator.send;
  return (
    <>
      <Text size="sm" className="dim">
        Emulated {state.depth}.
      </Text>
      <EmulatorTime state={state} send={send} />
      <Faults faults={state.faults} names={FAULTS} send={(change) => send({ faults: change })} />
      <Power send={send} note="What was stored comes back, everything else is as it was at first." />
    </>
  );
}
