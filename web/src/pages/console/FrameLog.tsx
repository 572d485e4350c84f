import { Button, Group, SegmentedControl, Switch, Text, TextInput } from "@mantine/core";
import { useElementSize } from "@mantine/hooks";
import { notifications } from "@mantine/notifications";
import { IconListDetails, IconPlayerPause, IconPlayerPlay, IconSearch } from "@tabler/icons-react";
import { useEffect, useMemo, useRef, useState } from "react";
import type { Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { optionsOf } from "../../lib/choices";
import { EmptyState } from "../../lib/EmptyState";
import { duration, fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import css from "./console.module.css";
import { FrameDetail } from "./FrameDetail";
import { asCsv, asText, clock, type Filter, type Frame, isBad, passes, type Show } from "./log";
import { useFrameLog } from "./useFrameLog";

const ROW_PX = 22;
const AROUND = 12;

/** Samples are many, a stop is one. */
const PRIORITY_LOOKS: Record<string, string> = { sample: "dim", stop: "bold" };

/** What went over the wire, live: every transaction, decoded. */
export function FrameLog({ device }: { device: Device }) {
  const [paused, setPaused] = useState(false);
  const log = useFrameLog(device, paused);
  const [filter, setFilter] = useState<Filter>({ text: "", show: "all", errorsOnly: false });
  const [selected, setSelected] = useState<number | null>(null);
  const shown = useMemo(() => log.frames.filter((frame) => passes(frame, filter)), [log.frames, filter]);
  const chosen = selected === null ? undefined : log.frames.find((frame) => frame.seq === selected);
  const list = useRef<ListHandle>(null);
  const lastBad = log.frames.findLast(isBad);

  async function copy(text: string, what: string) {
    try {
      await navigator.clipboard.writeText(text);
      notifications.show({ color: "gray", message: `${fixed(shown.length)} frames copied ${what}`, autoClose: 2000 });
    } catch {
      notifications.show({
        color: "red",
        title: "Not copied",
        message: "This browser lets pages write to the clipboard only over https or on localhost.",
      });
    }
  }

  function toLastBad() {
    if (!lastBad) return;
    if (!passes(lastBad, filter)) setFilter({ text: "", show: "all", errorsOnly: false });
    setSelected(lastBad.seq);
    list.current?.reveal(lastBad.seq);
  }

  return (
    <Card
      title="Frames"
      note={
        <span className="num">
          {fixed(shown.length)} of {fixed(log.frames.length)}
          {log.missed > 0 && `, ${fixed(log.missed)} came faster than they could be read`}
        </span>
      }
      actions={
        <>
          <Button
            size="compact-xs"
            variant="default"
            leftSection={paused ? <IconPlayerPlay size={13} aria-hidden /> : <IconPlayerPause size={13} aria-hidden />}
            onClick={() => setPaused(!paused)}
          >
            {paused ? "Resume" : "Pause"}
          </Button>
          <Button size="compact-xs" variant="default" disabled={!lastBad} onClick={toLastBad}>
            Last error
          </Button>
          <Button
            size="compact-xs"
            variant="default"
            disabled={shown.length === 0}
            onClick={() => void copy(asText(shown), "as text")}
          >
            Copy text
          </Button>
          <Button
            size="compact-xs"
            variant="default"
            disabled={shown.length === 0}
            onClick={() => void copy(asCsv(shown), "as CSV")}
          >
            Copy CSV
          </Button>
          <Button size="compact-xs" variant="default" disabled={log.frames.length === 0} onClick={log.clear}>
            Clear
          </Button>
        </>
      }
    >
      {log.error !== null && device.state === "connected" && (
        <ProblemAlert error={log.error} doing="Reading the frame log" />
      )}
      <Group gap="xs" mb={6}>
        <TextInput
          className={css.logSearch}
          aria-label="Filter frames"
          placeholder="Text, hex, or status"
          leftSection={<IconSearch size={13} aria-hidden />}
          value={filter.text}
          onChange={(event) => setFilter({ ...filter, text: event.currentTarget.value })}
        />
        <SegmentedControl
          aria-label="Which frames"
          data={optionsOf({ all: "All", commands: "Commands", samples: "Telemetry" })}
          value={filter.show}
          onChange={(show) => setFilter({ ...filter, show: show as Show })}
        />
        <Switch
          label="Errors only"
          checked={filter.errorsOnly}
          onChange={(event) => setFilter({ ...filter, errorsOnly: event.currentTarget.checked })}
        />
      </Group>
      {shown.length === 0 ? (
        <EmptyState
          title={log.frames.length === 0 ? "No frame yet" : "No frame passes the filter"}
          icon={<IconListDetails size={22} />}
        >
          <Text size="sm" className="m-0 dim" maw={360}>
            {log.frames.length === 0
              ? device.state === "connected"
                ? "Send a command, or look at another page: whatever goes over the wire is listed here."
                : `${device.name} is not connected: nothing goes over its wire.`
              : "Other frames are there: change the filter to see them."}
          </Text>
        </EmptyState>
      ) : (
        <List frames={shown} handle={list} selected={selected} onSelect={setSelected} />
      )}
      {chosen && <FrameDetail frame={chosen} onClose={() => setSelected(null)} />}
    </Card>
  );
}

interface ListHandle {
  reveal: (seq: number) => void;
}

interface ListProps {
  frames: readonly Frame[];
  handle: React.RefObject<ListHandle | null>;
  selected: number | null;
  onSelect: (seq: number | null) => void;
}

/** Only the rows in sight are drawn; while the end is in sight, it stays so. */
function List({ frames, handle, selected, onSelect }: ListProps) {
  const box = useRef<HTMLDivElement>(null);
  const { ref: sized, height } = useElementSize<HTMLDivElement>();
  const [top, setTop] = useState(0);
  const atEnd = useRef(true);
  const wanted = useRef<number | null>(null);

  handle.current = {
    reveal: (seq) => {
      atEnd.current = false;
      wanted.current = seq;
    },
  };

  useEffect(() => {
    const element = box.current;
    if (!element) return;
    if (wanted.current !== null) {
      const index = frames.findIndex((frame) => frame.seq === wanted.current);
      if (index >= 0) {
        element.scrollTop = index * ROW_PX - element.clientHeight / 2;
        wanted.current = null;
      }
    } else if (atEnd.current) element.scrollTop = element.scrollHeight;
  });

  const sight = height || 600;
  // At the end new rows are in sight at once: the event of scrolling there comes a frame later, and that would be blank.
  const from = atEnd.current && wanted.current === null ? Math.max(0, frames.length * ROW_PX - sight) : top;
  const first = Math.max(0, Math.floor(from / ROW_PX) - AROUND);
  const last = Math.min(frames.length, Math.ceil((from + sight) / ROW_PX) + AROUND);
  function step(by: number) {
    const index = frames.findIndex((frame) => frame.seq === selected);
    const next = frames[index < 0 ? frames.length - 1 : Math.max(0, Math.min(frames.length - 1, index + by))];
    if (!next) return;
    atEnd.current = false;
    onSelect(next.seq);
    wanted.current = next.seq;
  }

  return (
    <div className={css.logFrame} data-short={selected !== null} ref={sized}>
      <div
        ref={box}
        className={`${css.logBox} box text-12 mono scroll`}
        role="listbox"
        aria-label="Frames, newest last"
        tabIndex={0}
        aria-activedescendant={selected === null ? undefined : `frame-${selected}`}
        onScroll={(event) => {
          const element = event.currentTarget;
          setTop(element.scrollTop);
          atEnd.current = element.scrollHeight - element.scrollTop - element.clientHeight < ROW_PX;
        }}
        onKeyDown={(event) => {
          if (event.key === "ArrowDown") step(1);
          else if (event.key === "ArrowUp") step(-1);
          else if (event.key === "PageDown") step(15);
          else if (event.key === "PageUp") step(-15);
          else if (event.key === "End") {
            atEnd.current = true;
            onSelect(null);
          } else return;
          event.preventDefault();
        }}
      >
        <div role="presentation" style={{ height: frames.length * ROW_PX, position: "relative" }}>
          {frames.slice(first, last).map((frame, index) => (
            // biome-ignore lint/a11y/useFocusableInteractive: the list has the focus, as listboxes do
            // biome-ignore lint/a11y/useKeyWithClickEvents: the list hears the keys
            <div
              key={frame.seq}
              id={`frame-${frame.seq}`}
              role="option"
              aria-selected={frame.seq === selected}
              className={`${css.logRow} lit grid gap-8 nowrap`}
              style={{ top: (first + index) * ROW_PX }}
              onClick={() => onSelect(frame.seq === selected ? null : frame.seq)}
            >
              <span className="dim">{clock(frame.time_unix_s)}</span>
              <span className={`${css.logPriority} ${PRIORITY_LOOKS[frame.priority] ?? ""}`}>{frame.priority}</span>
              <span className={isBad(frame) ? "fault" : ""}>
                {frame.error === null ? frame.text : `${frame.text}: ${frame.error}`}
              </span>
              <span className={`${css.logBytes} dim`}>
                {frame.tx} → {frame.rx ?? "nothing"}
              </span>
              <span className="dim right">{duration(frame.took_ms / 1000)}</span>
            </div>
          ))}
        </div>
      </div>
    </div>
  );
}
