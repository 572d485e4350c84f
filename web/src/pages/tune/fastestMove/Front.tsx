import { Button, Group, Table, Text } from "@mantine/core";
import { useRef, useState } from "react";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { colorOf } from "../../../lib/palette";
import { useScheme } from "../../../lib/useScheme";
import { Plot } from "../../../plots/Plot";
import type { Study } from "../study";
import type { Changes } from "../useStudies";
import { choicesOf, frontOf, nearestOf, proofOf } from "./trials";

interface Props {
  study: Study;
  changes: Pick<Changes, "trial" | "start">;
}

/** The front of two objectives: one of its settings is chosen, in the plot or the list, and taken or proved. */
export function Front({ study, changes }: Props) {
  const scheme = useScheme();
  const [picked, setPicked] = useState<number | null>(null);
  const under = useRef<number | null>(null);
  const choices = choicesOf(study);
  const find = (number: number | null) => choices.find((trial) => trial.number === number);
  const chosen = find(picked) ?? find(study.best) ?? choices[0];
  if (chosen === undefined) return null;
  const proved = (number: number) => number === study.best && study.improved === true;
  const held = colorOf("velocity", scheme);
  const dots = { dots: 7, line: false } as const;
  const proof = proofOf(study, chosen);
  const pick = () => {
    const nearest = under.current === null ? undefined : nearestOf(choices, under.current);
    if (nearest) setPicked(nearest.number);
  };
  return (
    <Card title="Time and deviation" note={`${choices.length} settings that none beats in both`}>
      {/* biome-ignore lint/a11y/noStaticElementInteractions: a shortcut for the mouse to the list below */}
      {/* biome-ignore lint/a11y/useKeyWithClickEvents: a shortcut for the mouse to the list below */}
      <div onClick={pick}>
        <Plot
          label="Deviation over time: the front of both"
          summary={`Trial ${chosen.number} is chosen`}
          height={190}
          series={[
            { label: "held", color: held, ...dots },
            { label: "front", color: colorOf("acceleration", scheme), dots: 9, line: true },
            { label: "chosen", color: colorOf("residual", scheme), dots: 15, line: false },
          ]}
          x={{ label: "time", unit: "s" }}
          scales={{ y: { label: "deviation", unit: "full steps" } }}
          data={frontOf(study.trials, study.front, chosen.number)}
          onCursor={(at) => {
            under.current = at === null ? null : at.x;
          }}
        />
      </div>
      <Table withRowBorders={false} verticalSpacing={2} aria-label="Settings of the front">
        <Table.Thead>
          <Table.Tr>
            <Table.Th scope="col">Trial</Table.Th>
            {Object.entries(study.units).map(([name, unit]) => (
              <Table.Th key={name} scope="col">
                {name} [{unit}]
              </Table.Th>
            ))}
            <Table.Th scope="col">Time [s]</Table.Th>
            <Table.Th scope="col">Deviation [full steps]</Table.Th>
            <Table.Th scope="col" aria-label="How sure" />
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {choices.map(({ number, setting, figures }) => (
            <Table.Tr key={number}>
              <Table.Td>
                <label className="row gap-8">
                  <input
                    type="radio"
                    name={`front of ${study.id}`}
                    checked={number === chosen.number}
                    onChange={() => setPicked(number)}
                  />
                  {number}
                </label>
              </Table.Td>
              {Object.keys(study.units).map((name) => (
                <Table.Td key={name} className="num">
                  {compact(setting[name])}
                </Table.Td>
              ))}
              <Table.Td className="num">{compact(figures.time_s)}</Table.Td>
              <Table.Td className="num">{compact(figures.deviation_fullsteps, 3)}</Table.Td>
              <Table.Td>{proved(number) ? "best, proved" : number === study.best ? "best" : ""}</Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
      {study.state !== "running" && (
        <Group gap="xs" mt="xs">
          <Button
            size="compact-sm"
            variant={proved(chosen.number) ? "filled" : "default"}
            loading={changes.trial.isPending}
            onClick={() => changes.trial.mutate({ id: study.id, trial: chosen.number })}
          >
            Take trial {chosen.number}
            {proved(chosen.number) ? "" : " (not proved)"}
          </Button>
          {proof && !proved(chosen.number) && (
            <Button
              size="compact-sm"
              variant="default"
              loading={changes.start.isPending}
              onClick={() => changes.start.mutate(proof)}
            >
              Prove this one (moves)
            </Button>
          )}
        </Group>
      )}
      {!proved(chosen.number) && study.state !== "running" && (
        <Text size="sm" className="dim" mt={4}>
          It held when it was tried. A proof compares it with the setting before, in pairs, in a study of its own.
        </Text>
      )}
      {changes.trial.error && changes.trial.variables?.id === study.id && (
        <ProblemAlert error={changes.trial.error} doing="Taking it" onClose={() => changes.trial.reset()} />
      )}
    </Card>
  );
}
