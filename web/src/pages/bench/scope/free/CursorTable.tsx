import { Button, Table } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { IconCopy } from "@tabler/icons-react";
import { useEffect, useRef, useState } from "react";
import { compact } from "../../../../lib/format";
import { symbolOf } from "../../../../lib/units";
import { lowerBound } from "../../../../plots/series";
import type { ScopeTrace } from "../model";
import type { Scope } from "../useScope";
import type { Samples } from "./feed";
import classes from "./free.module.css";
import { statisticsOf } from "./statistics";

/** So often the figures follow samples that go on [ms]. */
const LOOK_MS = 300;
const HEADS = [
  "A",
  "B",
  "B − A",
  "slope [1/s]",
  "min",
  "max",
  "mean",
  "RMS",
  "SD",
  "peak to peak",
  "samples",
  "missing",
];

interface Line {
  key: string;
  name: string;
  values: number[];
}

/** What is between the cursors, of every channel that is shown: unfolded by its button. */
export function CursorFigures({ scope }: { scope: Scope }) {
  const [open, { toggle }] = useDisclosure();
  return (
    <>
      <Button size="compact-xs" variant="subtle" aria-expanded={open} onClick={toggle}>
        Figures
      </Button>
      {open && <CursorTable scope={scope} />}
    </>
  );
}

function CursorTable({ scope }: { scope: Scope }) {
  const [lines, setLines] = useState<Line[]>([]);
  const [copied, setCopied] = useState(false);
  const look = useRef(() => {});
  look.current = () => setLines(linesOf(scope));
  useEffect(() => {
    look.current();
    const timer = setInterval(() => look.current(), LOOK_MS);
    return () => clearInterval(timer);
  }, []);
  const copy = () => {
    const text = [["channel", ...HEADS], ...lines.map(({ name, values }) => [name, ...values.map(String)])];
    void navigator.clipboard.writeText(text.map((cells) => cells.join("\t")).join("\n")).then(() => setCopied(true));
  };
  return (
    <div className={classes.figures} data-testid="cursor-table">
      <Table className="text-12 num" horizontalSpacing={6} verticalSpacing={1}>
        <Table.Thead>
          <Table.Tr>
            <Table.Th>
              <Button
                size="compact-xs"
                variant="subtle"
                leftSection={<IconCopy size={13} aria-hidden />}
                onClick={copy}
              >
                {copied ? "Copied" : "Copy"}
              </Button>
            </Table.Th>
            {HEADS.map((head) => (
              <Table.Th key={head} className="right nowrap">
                {head}
              </Table.Th>
            ))}
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {lines.map(({ key, name, values }) => (
            <Table.Tr key={key} data-channel={key}>
              <Table.Th className="nowrap">{name}</Table.Th>
              {values.map((value, index) => (
                <Table.Td key={HEADS[index]} className="right nowrap" data-figure={HEADS[index]} data-value={value}>
                  {compact(value, 5)}
                </Table.Td>
              ))}
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </div>
  );
}

function linesOf(scope: Scope): Line[] {
  const { a, b } = scope.view.cursors();
  const [from, to] = a < b ? [a, b] : [b, a];
  // a little more: the last sample is one of them
  const reach: [number, number] = [from, to + 1e-9 + Number.EPSILON * Math.abs(to)];
  const rows = scope.rows.flatMap(({ row, traces }) =>
    row.id === "switches"
      ? []
      : traces
          .filter(({ shown }) => shown)
          .map((trace) => ({
            key: `${trace.device}:${trace.channel}`,
            name: `${trace.main ? trace.quantity.replaceAll("_", " ") : trace.label} [${symbolOf(trace.unit) || "1"}]`,
            samples: samplesOf(scope, trace, reach),
          })),
  );
  const free = [...scope.measured.values()].flat().map(({ key, label, unit, samples }) => ({
    key,
    name: `${label} [${unit || "1"}]`,
    samples: samples(reach),
  }));
  const seen = new Set<string>();
  return [...rows, ...free].flatMap(({ key, name, samples }) => {
    if (seen.has(key)) return [];
    seen.add(key);
    const [atA, atB] = [valueAt(samples, a), valueAt(samples, b)];
    const figures = statisticsOf(samples, from, to);
    const { minimum, maximum, mean, rms, sd, peakToPeak, samples: count, missing } = figures;
    const values = [
      atA,
      atB,
      atB - atA,
      (atB - atA) / (b - a),
      minimum,
      maximum,
      mean,
      rms,
      sd,
      peakToPeak,
      count,
      missing,
    ];
    return [{ key, name, values }];
  });
}

/** All samples of a trace in a window of the main device's time, in its unit. */
function samplesOf(scope: Scope, trace: ScopeTrace, [from, to]: readonly [number, number]): Samples {
  const source = scope.sourceOf(trace);
  const buffer = source && scope.view.bufferOf(source);
  const column = buffer?.column(trace.channel);
  if (!buffer || !column) return { times: new Float64Array(), values: new Float64Array() };
  const shift = scope.shiftOf(trace.device);
  const times = buffer.times();
  const [first, end] = [lowerBound(times, from - shift), lowerBound(times, to - shift)];
  return {
    times: times.subarray(first, end).map((time) => time + shift),
    values: column.subarray(first, end).map((value) => value / trace.divisor),
  };
}

/** Of the sample nearest to a time, among those between the cursors. */
function valueAt({ times, values }: Samples, time: number): number {
  const first = times[0] ?? Number.NaN;
  return Math.abs(time - first) <= Math.abs(time - (times.at(-1) ?? Number.NaN))
    ? (values[0] ?? Number.NaN)
    : (values.at(-1) ?? Number.NaN);
}
