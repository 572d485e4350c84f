import { ActionIcon, Button, Group, Menu, Text, Textarea, UnstyledButton } from "@mantine/core";
import { IconArrowDown, IconArrowUp, IconPlus, IconTrash } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { useRef, useState } from "react";
import type { Schemas } from "../../api/client";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useScheme } from "../../lib/useScheme";
import { Plot } from "../../plots/Plot";
import { fetchPiece, type RecordingDetail, useChanges, useFigures } from "./api";
import { labelOf, lanesOf, severalAxes } from "./channels";
import { FiguresTable } from "./FiguresTable";
import classes from "./recordings.module.css";
import type { Window } from "./ZoomData";

export type Cell = Schemas["CellOut"];
const FIGURE_POINTS = 1500;

interface Props {
  detail: RecordingDetail;
  /** what the plots show, which a new figure or table is of */
  window: Window | null;
  hidden: ReadonlySet<string>;
  onGo: (window: Window | null) => void;
}

/** The recording's notebook: text, figures and tables of statistics in the order that people put them in. */
export function Notebook({ detail, window, hidden, onGo }: Props) {
  const changes = useChanges();
  const [problem, setProblem] = useState<unknown>(null);
  const [editing, setEditing] = useState<number | null>(null);
  // What was changed last, before the server has told it: two changes follow each other faster than it answers.
  const [latest, setLatest] = useState({ cells: detail.notebook, revision: detail.notebook_revision });
  if (detail.notebook_revision > latest.revision)
    setLatest({ cells: detail.notebook, revision: detail.notebook_revision });
  const { cells } = latest;
  const several = severalAxes(detail.channels);
  const shown = detail.channels.filter((channel) => !hidden.has(labelOf(channel, several))).map(({ name }) => name);
  const writing = useRef<Promise<unknown>>(Promise.resolve());
  const save = (notebook: Cell[]) => {
    setProblem(null);
    const replaced = latest.revision;
    setLatest({ cells: notebook, revision: replaced + 1 });
    writing.current = writing.current
      .then(() => changes.label(detail.id, { notebook, notebook_revision: replaced }))
      .catch((error: unknown) => {
        setProblem(error);
        setLatest({ cells: detail.notebook, revision: detail.notebook_revision });
      });
  };
  const add = (kind: Cell["kind"]) => {
    const stretch =
      kind === "text" || window === null ? { from_s: null, to_s: null } : { from_s: window[0], to_s: window[1] };
    save([...cells, { kind, text: "", channels: kind === "text" ? [] : shown, ...stretch }]);
    setEditing(kind === "text" ? cells.length : null);
  };
  const move = (index: number, by: -1 | 1) => {
    const next = [...cells];
    const [cell] = next.splice(index, 1);
    if (cell) next.splice(index + by, 0, cell);
    setEditing(null);
    save(next);
  };
  return (
    <Card
      title="Notebook"
      actions={
        <Menu position="bottom-end">
          <Menu.Target>
            <Button size="compact-sm" variant="default" leftSection={<IconPlus size={14} aria-hidden />}>
              Add
            </Button>
          </Menu.Target>
          <Menu.Dropdown>
            <Menu.Item onClick={() => add("text")}>Text</Menu.Item>
            <Menu.Item onClick={() => add("figure")}>Figure of what is shown</Menu.Item>
            <Menu.Item onClick={() => add("table")}>Statistics of what is shown</Menu.Item>
          </Menu.Dropdown>
        </Menu>
      }
    >
      <ProblemAlert error={problem} doing="Keeping the notebook" onClose={() => setProblem(null)} />
      {cells.length === 0 && (
        <Text size="xs" c="dimmed">
          Text, figures and statistics of this recording, in your order: added with the button above.
        </Text>
      )}
      <ol className="list stack gap-8">
        {cells.map((cell, index) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: the place is all that tells a cell from one that says the same
          <li key={`${index}/${JSON.stringify(cell)}`} data-testid={`cell-${index + 1}`}>
            <Group gap={4} justify="flex-end">
              {cell.kind !== "text" && (
                <Button
                  size="compact-xs"
                  variant="subtle"
                  mr="auto"
                  onClick={() => onGo(cell.from_s === null || cell.to_s === null ? null : [cell.from_s, cell.to_s])}
                >
                  {stretchText(cell)}
                </Button>
              )}
              <CellButton label={`Move cell ${index + 1} up`} disabled={index === 0} onClick={() => move(index, -1)}>
                <IconArrowUp size={14} />
              </CellButton>
              <CellButton
                label={`Move cell ${index + 1} down`}
                disabled={index === cells.length - 1}
                onClick={() => move(index, 1)}
              >
                <IconArrowDown size={14} />
              </CellButton>
              <CellButton
                label={`Remove cell ${index + 1}`}
                onClick={() => {
                  setEditing(null);
                  save(cells.filter((_, other) => other !== index));
                }}
              >
                <IconTrash size={14} />
              </CellButton>
            </Group>
            {cell.kind === "figure" && <Figure detail={detail} cell={cell} />}
            {cell.kind === "table" && <Statistics detail={detail} cell={cell} />}
            {cell.kind === "text" &&
              (editing === index ? (
                <TextEditor
                  text={cell.text}
                  onSave={(text) => {
                    save(cells.map((each, other) => (other === index ? { ...each, text } : each)));
                    setEditing(null);
                  }}
                />
              ) : (
                <UnstyledButton w="100%" onClick={() => setEditing(index)}>
                  <Text size="sm" className={classes.note}>
                    {cell.text || "Empty: press to write"}
                  </Text>
                </UnstyledButton>
              ))}
          </li>
        ))}
      </ol>
    </Card>
  );
}

function stretchText({ from_s, to_s }: Cell): string {
  return from_s === null || to_s === null ? "All of it" : `${fixed(from_s, 3)} to ${fixed(to_s, 3)} s`;
}

interface ButtonProps {
  label: string;
  disabled?: boolean;
  onClick: () => void;
  children: React.ReactNode;
}

function CellButton({ label, disabled = false, onClick, children }: ButtonProps) {
  return (
    <ActionIcon size={24} variant="subtle" aria-label={label} disabled={disabled} onClick={onClick}>
      {children}
    </ActionIcon>
  );
}

function TextEditor({ text, onSave }: { text: string; onSave: (text: string) => void }) {
  const [draft, setDraft] = useState(text);
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        onSave(draft);
      }}
    >
      <Textarea
        aria-label="Text of the cell"
        autoFocus
        autosize
        minRows={2}
        maxRows={20}
        maxLength={4000}
        value={draft}
        onChange={(event) => setDraft(event.currentTarget.value)}
      />
      <Button type="submit" size="compact-sm" mt={4}>
        Keep
      </Button>
    </form>
  );
}

function windowOf({ from_s, to_s }: Cell): Window | null {
  return from_s === null || to_s === null ? null : [from_s, to_s];
}

/** Its channels over its stretch, a plot a unit. */
function Figure({ detail, cell }: { detail: RecordingDetail; cell: Cell }) {
  const scheme = useScheme();
  const window = windowOf(cell);
  const piece = useQuery({
    queryKey: ["notebook figure", detail.id, window, detail.rows],
    queryFn: () => fetchPiece(detail.id, window, FIGURE_POINTS),
    staleTime: Number.POSITIVE_INFINITY,
    retry: false,
  });
  if (!piece.data) return <ProblemAlert error={piece.error} doing="Reading the figure" />;
  const { x, columns } = piece.data;
  const lanes = lanesOf(detail.channels, scheme).map((lane) => {
    const kept = lane.columns.map(
      (column) => cell.channels.length === 0 || cell.channels.includes(detail.channels[column]?.name ?? ""),
    );
    return {
      ...lane,
      columns: lane.columns.filter((_, at) => kept[at]),
      series: lane.series.filter((_, at) => kept[at]),
    };
  });
  return lanes
    .filter((lane) => lane.columns.length > 0)
    .map((lane) => (
      <Plot
        key={lane.id}
        label={`${lane.title}, ${stretchText(cell)}`}
        title={lane.title}
        series={lane.series}
        data={[x, ...lane.columns.map((column) => columns[column] ?? new Float64Array(x.length).fill(Number.NaN))]}
        x={{ label: "time", unit: "s" }}
        scales={{ y: { unit: lane.unit } }}
        height={150}
        legend
        group={`notebook ${detail.id} ${stretchText(cell)}`}
      />
    ));
}

function Statistics({ detail, cell }: { detail: RecordingDetail; cell: Cell }) {
  const figures = useFigures(detail.id, windowOf(cell), detail.rows ?? 0, true);
  if (!figures.data) return <ProblemAlert error={figures.error} doing="Figures" />;
  const of = Object.entries(figures.data.figures).filter(
    ([name]) => cell.channels.length === 0 || cell.channels.includes(name),
  );
  return (
    <FiguresTable
      channels={detail.channels}
      sides={[{ id: detail.id, name: "", figures: Object.fromEntries(of) }]}
      stale={figures.isPlaceholderData}
    />
  );
}
