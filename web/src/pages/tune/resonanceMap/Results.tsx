import { Table } from "@mantine/core";
import { Card } from "../../../lib/Card";
import { compact } from "../../../lib/format";
import type { Study } from "../study";
import { Campbell } from "./Campbell";
import { ChangeCard } from "./Changes";
import { campbellOf, type ResonanceFound } from "./dots";

/** The map as a Campbell plot and as a table, and what each change made of it. */
export function Results({ study }: { study: Study }) {
  const found = study.resonances;
  return found ? <Found found={found} /> : null;
}

function Found({ found }: { found: ResonanceFound }) {
  const plot = campbellOf(found);
  if (plot === null) return null;
  const hz = found.resonance_hz;
  const summary = hz === null ? `${found.points.length} speeds` : `resonance ${compact(hz.value, 4, "Hz")}`;
  return (
    <>
      <Card title="Ripple over speed and order" note={summary}>
        <Campbell plot={plot} summary={summary} />
        <details>
          <summary className="text-13">The same as a table</summary>
          <MapTable found={found} />
        </details>
      </Card>
      {found.changes
        .filter(({ points }) => points.length > 0)
        .map((change) => (
          <ChangeCard key={change.name} change={change} />
        ))}
    </>
  );
}

function MapTable({ found }: { found: ResonanceFound }) {
  return (
    <Table.ScrollContainer minWidth={560} type="native">
      <Table withRowBorders={false} verticalSpacing={2} aria-label="Amplitude of each order at each speed">
        <Table.Thead>
          <Table.Tr>
            <Table.Th scope="col">turns/s</Table.Th>
            <Table.Th scope="col">ripple</Table.Th>
            {found.orders.map((order) => (
              <Table.Th key={order} scope="col">
                order {order}
              </Table.Th>
            ))}
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {found.points.map((point) => (
            <Table.Tr key={point.speed_rps}>
              <Table.Th scope="row">{compact(point.speed_rps, 3)}</Table.Th>
              <Table.Td className="num">{point.lost > 0 ? "steps lost" : `${compact(point.ripple_deg, 3)}°`}</Table.Td>
              {found.orders.map((order, index) => (
                <Table.Td key={order} className="num">
                  {compact(point.amplitudes_deg[index] ?? null, 2)}
                </Table.Td>
              ))}
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </Table.ScrollContainer>
  );
}
