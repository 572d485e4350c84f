import { Button, Group, Table, Text } from "@mantine/core";
import { compact } from "../../../lib/format";
import type { Study, Trial, Wish } from "../study";
import { choicesOf, proofOf } from "./trials";

interface Props {
  study: Study;
  chosen: Trial;
  onPick: (trial: number) => void;
  onTake: (trial: number) => void;
  onProve: (proof: Wish) => void;
  busy: boolean;
}

/** The settings of a front as a list of which one is chosen, and what to do with that: only the best one is proved. */
export function FrontChoice({ study, chosen, onPick, onTake, onProve, busy }: Props) {
  const proved = (number: number) => number === study.best && study.improved === true;
  const proof = proofOf(study, chosen);
  return (
    <>
      <Table.ScrollContainer minWidth={420} type="native">
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
            {choicesOf(study).map(({ number, setting, figures }) => (
              <Table.Tr key={number}>
                <Table.Td>
                  <label className="row gap-8">
                    <input
                      type="radio"
                      name={`front of ${study.id}`}
                      checked={number === chosen.number}
                      onChange={() => onPick(number)}
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
      </Table.ScrollContainer>
      {study.state !== "running" && (
        <Group gap="xs" mt="xs">
          <Button
            size="compact-sm"
            variant={proved(chosen.number) ? "filled" : "default"}
            disabled={busy}
            onClick={() => onTake(chosen.number)}
          >
            Take trial {chosen.number}
            {proved(chosen.number) ? "" : " (not proved)"}
          </Button>
          {proof && !proved(chosen.number) && (
            <Button size="compact-sm" variant="default" disabled={busy} onClick={() => onProve(proof)}>
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
    </>
  );
}
