import { Switch, Text } from "@mantine/core";
import { counted } from "../../../lib/format";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { useStudies, useWatch } from "../useStudies";

interface Props {
  device: string;
  axis: number;
}

/** Switches on that every move of an axis is noticed, recorded and scored, whoever makes it. */
export function Watch({ device, axis }: Props) {
  const watch = useStudies().data?.watches.find((one) => one.device === device && one.axis === axis);
  const change = useWatch(device, axis);
  return (
    <>
      <Switch
        label="Score every move of this axis"
        description="Whoever makes it: on any page, over REST, by a script. It has to rest for half a second afterwards."
        checked={watch !== undefined}
        disabled={change.isPending}
        onChange={({ currentTarget }) => change.mutate(currentTarget.checked)}
      />
      {watch && (
        <Text size="sm" role="status">
          {watch.message || told(watch.noticed, watch.missed)}
        </Text>
      )}
      <ProblemAlert error={change.error} doing="Switching that" onClose={() => change.reset()} />
    </>
  );
}

function told(noticed: number, missed: number): string {
  const moves = `${counted(noticed, "move")} ${noticed === 1 ? "was" : "were"}`;
  const others =
    missed === 0
      ? ""
      : `; ${missed} could not be: stopped on the way but by a stall, to and fro without a rest, or too short`;
  return `On: ${moves} scored since${others}.`;
}
