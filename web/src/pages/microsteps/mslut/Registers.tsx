import { Card } from "../../../lib/Card";
import { Copy, Paste } from "../Paste";
import { cArray, hexLines, pairOf, parseWave, type Table, WIDTH_HUES } from "./wave";

interface Props {
  /** null while the wave cannot be encoded */
  table: Table | null;
  /** what the chip holds */
  held: Table | null;
  onPaste: (values: number[], mirror: number) => void;
}

/** The registers that hold the wave: beside the chip's, out as C or hex, and in from text. */
export function Registers({ table, held, onPaste }: Props) {
  const rows = table?.registers ?? held?.registers ?? [];

  return (
    <Card
      title="Registers"
      actions={
        <>
          <Copy label="Hex" text={table ? hexLines(table.registers) : ""} />
          <Copy label="C array" text={table ? cArray(table.registers) : ""} />
          <Paste
            what="wave"
            help="256 values of 0 to 255, or the ten register words MSLUT[0] to [7], MSLUTSEL and MSLUTSTART, with or without their addresses; separated by spaces, commas or lines, or as a C array."
            use="Use this wave"
            parse={parseWave}
            onPaste={({ values, mirror }) => onPaste(values, mirror)}
          />
        </>
      }
    >
      <table className="figures">
        <thead>
          <tr>
            <th scope="col">register</th>
            <th scope="col">address</th>
            <th scope="col">design</th>
            <th scope="col">chip</th>
          </tr>
        </thead>
        <tbody>
          {rows.map((row, at) => {
            const design = table?.registers[at];
            const chip = held?.registers[at];
            return (
              <tr key={row.name}>
                <th scope="row">{row.name.replaceAll("___", " · ")}</th>
                <td className="num">0x{row.address.toString(16).toUpperCase()}</td>
                <td className="num">{design ? design.hex : <span className="dim">cannot be encoded</span>}</td>
                <td className={`num ${design && chip && design.value !== chip.value ? "caution" : ""}`}>
                  {chip?.hex ?? "–"}
                </td>
              </tr>
            );
          })}
        </tbody>
      </table>
      {table && (
        <p className="lines-12 m-0 mt-8 text-12">
          {table.segments.map((segment) => (
            <span key={segment.first} className="inline gap-4">
              <i className={`swatch swatch-square faint ${WIDTH_HUES[segment.width] ?? ""}`} />
              <span className="num">
                {segment.first}–{segment.last}
              </span>
              W{segment.width}, differences {pairOf(segment.low)}
            </span>
          ))}
        </p>
      )}
    </Card>
  );
}
