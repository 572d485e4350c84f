import { Button, Checkbox, Drawer, Group, Progress, Text, TextInput, UnstyledButton } from "@mantine/core";
import { useDebouncedValue, useDisclosure } from "@mantine/hooks";
import { IconArrowsDiff, IconPlayerRecord, IconPlayerStop, IconReportAnalytics, IconSearch } from "@tabler/icons-react";
import { useMemo, useState } from "react";
import { Link, useLocation } from "wouter";
import { Ago } from "../../lib/Ago";
import { Card } from "../../lib/Card";
import { EmptyState } from "../../lib/EmptyState";
import { fixed, sizeText } from "../../lib/format";
import { Loading } from "../../lib/Loading";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useScheme } from "../../lib/useScheme";
import { isRunning, PAGE, PAGE_MAX, type Recording, titleOf, useChanges, useRecordings } from "./api";
import { sideLook } from "./compare";
import { REPORTED_MAX } from "./ReportView";
import { RowMenu } from "./RowMenu";
import classes from "./recordings.module.css";
import { StartForm } from "./StartForm";
import { Thumbnail } from "./Thumbnail";
import { order, type Sort, type SortKey, stateText } from "./words";

const COLUMNS: readonly { key: SortKey; label: string; wide?: boolean; right?: boolean }[] = [
  { key: "name", label: "Name" },
  { key: "device", label: "Device", wide: true },
  { key: "started_unix_s", label: "When" },
  { key: "channels", label: "Channels", wide: true },
  { key: "size_bytes", label: "Size", right: true },
  { key: "state", label: "State", wide: true },
];
const COMPARED_MAX = 8;

/** All recordings: found again, put side by side, started and ended. */
export function ListView() {
  const [text, setText] = useState("");
  const [search] = useDebouncedValue(text.trim(), 200);
  const [limit, setLimit] = useState(PAGE);
  const list = useRecordings(search, limit);
  const [sort, setSort] = useState<Sort>({ key: "started_unix_s", down: true });
  const [picked, setPicked] = useState<ReadonlySet<string>>(new Set());
  const [starting, { open, close }] = useDisclosure();
  const [problem, setProblem] = useState<{ doing: string; error: unknown } | null>(null);
  const [, go] = useLocation();
  const changes = useChanges();
  const found = list.data?.recordings;
  const sorted = useMemo(() => (found ? order(found, sort) : []), [found, sort]);
  const chosen = sorted.filter(({ id }) => picked.has(id));

  const attempt = (doing: string, work: () => Promise<unknown>) => {
    setProblem(null);
    work().catch((error: unknown) => setProblem({ doing, error }));
  };
  const pick = (id: string, on: boolean) =>
    setPicked((before) => {
      const after = new Set(before);
      if (on) after.add(id);
      else after.delete(id);
      return after;
    });

  return (
    <Page name="Recordings">
      {problem && <ProblemAlert {...problem} onClose={() => setProblem(null)} />}
      <Card
        title="Recordings"
        note={list.data && <DiskUse {...list.data} />}
        actions={
          <>
            <TextInput
              type="search"
              className={classes.search}
              aria-label="Search recordings"
              placeholder="name, note, tag, device, model"
              leftSection={<IconSearch size={14} aria-hidden />}
              value={text}
              onChange={(event) => setText(event.currentTarget.value)}
            />
            <Button
              variant="default"
              leftSection={<IconArrowsDiff size={15} aria-hidden />}
              disabled={chosen.length < 2 || chosen.length > COMPARED_MAX}
              title={chosen.length > COMPARED_MAX ? `at most ${COMPARED_MAX}` : "pick two or more below"}
              onClick={() => go(`/recordings/compare?of=${chosen.map(({ id }) => id).join(",")}`)}
            >
              Compare{chosen.length > 0 ? ` ${chosen.length}` : ""}
            </Button>
            <Button
              variant="default"
              leftSection={<IconReportAnalytics size={15} aria-hidden />}
              disabled={chosen.length === 0 || chosen.length > REPORTED_MAX}
              title={chosen.length > REPORTED_MAX ? `at most ${REPORTED_MAX}` : "pick some below"}
              onClick={() => go(`/recordings/report?of=${chosen.map(({ id }) => id).join(",")}`)}
            >
              Report
            </Button>
            <Button leftSection={<IconPlayerRecord size={15} aria-hidden />} onClick={open}>
              Record
            </Button>
          </>
        }
      >
        {list.isError && list.data === undefined ? (
          <ProblemAlert error={list.error} doing="Reading the list" retry={() => void list.refetch()} />
        ) : list.data === undefined ? (
          <Group justify="center" py="xl">
            <Loading label="Reading the list" />
          </Group>
        ) : sorted.length === 0 && list.data.unread === 0 ? (
          <EmptyState
            title={
              search ? `Nothing has “${search}” in its name, note, tags, device or model` : "Nothing is recorded yet"
            }
            icon={<IconPlayerRecord size={22} />}
          >
            {search ? (
              <Button size="sm" variant="default" onClick={() => setText("")}>
                Show all
              </Button>
            ) : (
              <>
                <Text size="sm">
                  A recording keeps channels of a device, what was done meanwhile, and how it was set.
                </Text>
                <Button size="sm" onClick={open}>
                  Record
                </Button>
              </>
            )}
          </EmptyState>
        ) : (
          <table className={`table text-13 ${classes.list}`} data-testid="recordings">
            <thead>
              <tr>
                <th className={classes.tick}>
                  <span className="unseen">Compare</span>
                </th>
                <th className={classes.wide}>Shape</th>
                {COLUMNS.map(({ key, label, wide, right }) => (
                  <th
                    key={key}
                    className={`${wide ? classes.wide : ""} ${right ? "right" : ""}`}
                    aria-sort={sort.key === key ? (sort.down ? "descending" : "ascending") : "none"}
                  >
                    <UnstyledButton
                      className="plain nowrap"
                      onClick={() => setSort({ key, down: sort.key === key ? !sort.down : key !== "name" })}
                    >
                      {label}
                      <span aria-hidden>{sort.key === key ? (sort.down ? " ↓" : " ↑") : ""}</span>
                    </UnstyledButton>
                  </th>
                ))}
                <th>
                  <span className="unseen">Actions</span>
                </th>
              </tr>
            </thead>
            <tbody>
              {sorted.map((recording) => (
                <Row
                  key={recording.id}
                  recording={recording}
                  picked={picked.has(recording.id)}
                  onPick={(on) => pick(recording.id, on)}
                  onStop={() => attempt("Ending the recording", () => changes.stop(recording.id))}
                  attempt={attempt}
                />
              ))}
            </tbody>
          </table>
        )}
        {list.data && list.data.unread > 0 && (
          <Text size="sm" c="dimmed" ta="center" py="sm" role="status" data-testid="recordings-unread">
            Searching: <span className="num">{list.data.unread}</span> older recordings are not read yet.
          </Text>
        )}
        {list.data && list.data.total > sorted.length && (
          <Group justify="center" gap="sm" py="sm">
            <Text size="sm">
              The latest <span className="num">{sorted.length}</span> of <span className="num">{list.data.total}</span>
            </Text>
            {limit < PAGE_MAX ? (
              <Button
                variant="default"
                loading={list.isFetching && list.isPlaceholderData}
                onClick={() => setLimit((before) => Math.min(before + PAGE, PAGE_MAX))}
              >
                Show {PAGE} more
              </Button>
            ) : (
              <Text size="sm">Search to find older ones.</Text>
            )}
          </Group>
        )}
      </Card>
      <Drawer opened={starting} onClose={close} position="right" title="New recording" size="sm">
        <StartForm
          onStarted={(id) => {
            close();
            go(`/recordings/${id}`);
          }}
        />
      </Drawer>
    </Page>
  );
}

interface RowProps {
  recording: Recording;
  picked: boolean;
  onPick: (on: boolean) => void;
  onStop: () => void;
  attempt: (doing: string, work: () => Promise<unknown>) => void;
}

function Row({ recording, picked, onPick, onStop, attempt }: RowProps) {
  const title = titleOf(recording);
  const readable = recording.device !== null;
  return (
    <tr className={isRunning(recording) ? classes.running : ""} data-testid={recording.id}>
      <td className={classes.tick}>
        <Checkbox
          aria-label={`Compare ${title}`}
          checked={picked}
          disabled={!readable}
          onChange={(event) => onPick(event.currentTarget.checked)}
        />
      </td>
      <td className={classes.wide}>
        <Thumbnail recording={recording} />
      </td>
      <td className="anywhere">
        {readable ? (
          <Link href={`/recordings/${recording.id}`} className={`${classes.link} bold`}>
            {title}
          </Link>
        ) : (
          title
        )}
        <Tags recording={recording} />
        {recording.note && <div className={`${classes.rowNote} clip hint`}>{recording.note}</div>}
        {recording.message && <div className={`${classes.rowNote} clip hint`}>{recording.message}</div>}
      </td>
      <td className={classes.wide}>
        {recording.device ?? "–"} <span className="dim">{recording.model}</span>
      </td>
      <td>
        <Ago unixS={recording.started_unix_s} />
      </td>
      <td className={classes.wide} title={recording.channels.map(({ name }) => name).join(", ")}>
        {recording.channels.length} <span className="dim">at {fixed(recording.rate_hz, 0, "Hz")}</span>
      </td>
      <td className="num right">{sizeText(recording.size_bytes)}</td>
      <td className={`${classes.wide} ${recording.state === "failed" ? "fault bold" : "dim"}`}>
        {stateText(recording)}
      </td>
      <td className="right nowrap">
        {isRunning(recording) && (
          <Button
            size="compact-xs"
            variant="default"
            leftSection={<IconPlayerStop size={13} aria-hidden />}
            onClick={onStop}
          >
            End
          </Button>
        )}
        <RowMenu recording={recording} attempt={attempt} />
      </td>
    </tr>
  );
}

/** What it is found by, and the colour that it has in comparisons. */
export function Tags({ recording: { tags, colour } }: { recording: Recording }) {
  const scheme = useScheme();
  if (tags.length === 0 && colour === "") return null;
  return (
    <span className="inline wrap gap-4">
      {colour && (
        <span
          className="swatch"
          style={{ background: sideLook(0, scheme, colour).color }}
          title={`${colour} in comparisons`}
        />
      )}
      {tags.map((tag) => (
        <span key={tag} className="tag" data-testid="tag">
          {tag}
        </span>
      ))}
    </span>
  );
}

function DiskUse({
  size_bytes,
  free_bytes,
  room_bytes,
}: {
  size_bytes: number | null;
  free_bytes: number;
  room_bytes: number;
}) {
  const disk_bytes = (size_bytes ?? 0) + free_bytes;
  const share = (100 * (size_bytes ?? 0)) / Math.max(1, disk_bytes);
  const low = room_bytes < Math.max(1e9, 0.02 * disk_bytes);
  return (
    <span className={`inline wrap gap-6 ${low ? "caution" : ""}`}>
      <span className="num">{size_bytes === null ? "–" : sizeText(size_bytes)}</span> kept,{" "}
      <span className="num">{sizeText(room_bytes)}</span> room
      <Progress value={share} size={5} w={64} aria-label="Share of the disk" />
      {low && (
        <span>{room_bytes === 0 ? "The disk is full: nothing can be recorded." : "The disk is nearly full."}</span>
      )}
    </span>
  );
}
