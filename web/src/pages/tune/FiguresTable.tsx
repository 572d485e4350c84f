import { Table } from "@mantine/core";

/** Figures stay on one line; what is as long as this is none. */
const SENTENCE = 40;

interface Props {
  label: string;
  minWidth: number;
  /** the first is that of the rows' names */
  heads: readonly string[];
  /** each with its name first, which no other has */
  rows: readonly (readonly [string, ...string[]])[];
}

/** Figures below their headings; where they are wider than a phone they are scrolled sideways. */
export function FiguresTable({ label, minWidth, heads, rows }: Props) {
  return (
    <Table.ScrollContainer minWidth={minWidth} type="native">
      <Table mt="xs" withRowBorders={false} verticalSpacing={2} aria-label={label}>
        <Table.Thead>
          <Table.Tr>
            {heads.map((head) => (
              <Table.Th key={head} scope="col">
                {head}
              </Table.Th>
            ))}
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {rows.map(([name, ...cells]) => (
            <Table.Tr key={name}>
              <Table.Th scope="row">{name}</Table.Th>
              {cells.map((cell, index) => (
                <Table.Td
                  key={heads[index + 1]}
                  {...(cell.length < SENTENCE ? { className: "num" } : { miw: "12rem" })}
                >
                  {cell}
                </Table.Td>
              ))}
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </Table.ScrollContainer>
  );
}
