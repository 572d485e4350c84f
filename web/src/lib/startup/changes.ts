import type { Schemas } from "../../api/client";
import { fixed } from "../format";
import { READ_BACK, WRITTEN_BLIND } from "../rows/proof";

export type Report = Schemas["StartUpReport"];
type Write = Report["writes"][number];

export interface Line {
  key: string;
  name: string;
  axis: number | null;
  before: string;
  after: string;
  /** in physical units, "" where a number means nothing but itself */
  beforePhysical: string;
  afterPhysical: string;
  /** "" of a dry run */
  readBack: string;
}

/** What a start-up writes, a line a register; the words of a table are one line together. */
export function linesOf(report: Report): Line[] {
  const tables = new Map<string, Write[]>();
  for (const write of report.writes)
    if (write.table !== null) tables.set(write.table, [...(tables.get(write.table) ?? []), write]);
  return [
    ...[...tables].map(([table, words]) => ({
      key: table,
      name: `${table.replaceAll("_", " ")} table`,
      axis: null,
      before: "",
      after: `${fixed(words.length)} words`,
      beforePhysical: "",
      afterPhysical: "",
      readBack: told(report, words[0]),
    })),
    ...report.writes
      .filter((write) => write.table === null)
      .map((write) => ({
        key: `${write.axis ?? "-"}/${write.name}`,
        name: write.name,
        axis: write.axis,
        before: write.left === null ? "unknown" : side(write, "left"),
        after: side(write, "right"),
        beforePhysical: write.left_physical ?? "",
        afterPhysical: write.right_physical ?? "",
        readBack: told(report, write),
      })),
  ];
}

function side(write: Write, which: "left" | "right"): string {
  if (write.fields.length === 0) return number(write[which]);
  return write.fields.map((field) => `${field.name} ${field[`${which}_meaning`] || number(field[which])}`).join(", ");
}

function number(value: number | string | null | undefined): string {
  return typeof value === "number" ? fixed(value) : (value ?? "unknown");
}

function told(report: Report, write: Write | undefined): string {
  if (report.state === "dry run") return "";
  return write?.verified ? READ_BACK : WRITTEN_BLIND;
}
