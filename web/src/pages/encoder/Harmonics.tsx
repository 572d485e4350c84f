import { Table, Text } from "@mantine/core";
import { Fragment, useState } from "react";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import type { AngleMap, Direction } from "./angleMap";
import { fitTurn, type TurnFit } from "./harmonics";
import type { Curve } from "./Polar";
import { useMapChanges } from "./useEncoder";

const ROWS: readonly { perTurn: (fullSteps: number) => number; name: string }[] = [
  { perTurn: () => 1, name: "eccentricity" },
  { perTurn: () => 2, name: "ellipse, tilt" },
  { perTurn: () => 3, name: "" },
  { perTurn: () => 4, name: "" },
  { perTurn: (fullSteps) => fullSteps / 4, name: "coil offset" },
  { perTurn: (fullSteps) => fullSteps / 2, name: "coil difference" },
  { perTurn: (fullSteps) => fullSteps, name: "detent, each full step" },
];

interface Fitted {
  fits: TurnFit[];
  reversal: number[];
}

function fitOf(map: AngleMap, direction: Direction): TurnFit {
  return fitTurn(map.turn(direction, map.fullStepsPerTurn), map.period(direction), map.fullStepsPerTurn);
}

/** What the deviation over a turn is made of, in numbers. Every row is there from the start. */
export function Harmonics({ curves, direction }: { curves: readonly Curve[]; direction: Direction }) {
  const [fitted, setFitted] = useState<Fitted | null>(null);
  useMapChanges(
    curves.map((curve) => curve.map),
    `${direction} ${curves.map((curve) => curve.label).join()}`,
    () =>
      setFitted({
        fits: curves.map((curve) => fitOf(curve.map, direction)),
        reversal: curves.map((curve) => curve.map.reversal()),
      }),
  );
  const first = curves[0];
  if (!first) return null;
  const { fullStepsPerTurn, microstepsPerTurn } = first.map;
  const degrees = (microsteps: number) => (microsteps / microstepsPerTurn) * 360;
  // beside each other there is no room for degrees
  const alone = curves.length === 1;
  const complete = fitted?.fits.some((fit) => fit.turn !== null) ?? false;
  return (
    <Card
      title="Harmonics"
      note={complete ? "amplitude; phase from position 0" : "after one whole turn, with samples in every 45°"}
    >
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: on a phone it scrolls sideways, with the keys too */}
      <section className="scroll-x" tabIndex={0} aria-label="Orders of the deviation">
        <Table className="text-12 nowrap" withRowBorders={false} verticalSpacing={1} horizontalSpacing={6}>
          <Table.Thead>
            <Table.Tr>
              <Table.Th>a turn</Table.Th>
              <Table.Th>from</Table.Th>
              {curves.map(({ label }) => (
                <Fragment key={label}>
                  <Table.Th ta="right">{curves.length > 1 ? label : ""} µsteps</Table.Th>
                  {alone && <Table.Th ta="right">°</Table.Th>}
                  <Table.Th ta="right">phase</Table.Th>
                </Fragment>
              ))}
            </Table.Tr>
          </Table.Thead>
          <Table.Tbody data-testid="harmonics">
            {ROWS.map(({ perTurn, name }) => {
              const order = perTurn(fullStepsPerTurn);
              return (
                <Table.Tr key={order} data-order={order}>
                  <Table.Td className="num">{fixed(order)}×</Table.Td>
                  <Table.Td c="dimmed">{name}</Table.Td>
                  {curves.map(({ label }, index) => {
                    const term = fitted?.fits[index]?.named.find((candidate) => candidate.perTurn === order);
                    return (
                      <Fragment key={label}>
                        <Table.Td className="num" ta="right" fw={600}>
                          {fixed(term?.amplitude, 2)}
                        </Table.Td>
                        {alone && (
                          <Table.Td className="num" ta="right">
                            {fixed(term && degrees(term.amplitude), 3)}
                          </Table.Td>
                        )}
                        <Table.Td className="num" ta="right">
                          {term && term.amplitude > 0 ? `${fixed((term.phase * 180) / Math.PI)}°` : "–"}
                        </Table.Td>
                      </Fragment>
                    );
                  })}
                </Table.Tr>
              );
            })}
            <Table.Tr>
              <Table.Td />
              <Table.Td c="dimmed">mean, the offset</Table.Td>
              {curves.map(({ label }, index) => {
                const offset = fitted?.fits[index]?.turn?.offset;
                return (
                  <Fragment key={label}>
                    <Table.Td className="num" ta="right" fw={600}>
                      {fixed(offset, 2)}
                    </Table.Td>
                    {alone && (
                      <Table.Td className="num" ta="right">
                        {fixed(offset === undefined ? undefined : degrees(offset), 3)}
                      </Table.Td>
                    )}
                    <Table.Td />
                  </Fragment>
                );
              })}
            </Table.Tr>
            <Table.Tr>
              <Table.Td />
              <Table.Td c="dimmed">back − forward, friction</Table.Td>
              {curves.map(({ label }, index) => {
                const reversal = fitted?.reversal[index];
                return (
                  <Fragment key={label}>
                    <Table.Td className="num" ta="right" fw={600}>
                      {fixed(reversal, 2)}
                    </Table.Td>
                    {alone && (
                      <Table.Td className="num" ta="right">
                        {fixed(reversal === undefined ? undefined : degrees(reversal), 3)}
                      </Table.Td>
                    )}
                    <Table.Td />
                  </Fragment>
                );
              })}
            </Table.Tr>
          </Table.Tbody>
        </Table>
      </section>
      <Text size="xs" c="dimmed">
        Smaller than a step of the encoder is found, too: it comes from many samples.
      </Text>
    </Card>
  );
}
