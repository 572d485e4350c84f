import { Button, Group, Text, TextInput } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useRef, useState } from "react";
import { api, type Problem, problemOf } from "../../api/client";
import type { Device } from "../../api/queries";
import { hex } from "../../lib/format";
import { type RegisterRow, readable, writable } from "../../lib/rows/bits";
import { Shared, useShared } from "../../lib/shared";
import { timeOf } from "../../lib/time";
import { useLinkInfo } from "../../lib/wire/useLinkInfo";
import {
  decodedLines,
  decodeRequest,
  frameText,
  parseFrame,
  type Request,
  sizeText,
  type Wire,
  wireOf,
} from "./frames";

interface Entry {
  id: number;
  at: Date;
  sent: string;
  reply: string | null;
  lines: [string, string][];
  problem: Problem | null;
}

const KEPT = 50;
const STATUS_ALONE = "00";

/** What was exchanged with each device, until the page is reloaded. */
const history = new Shared<Readonly<Record<string, readonly Entry[]>>>({});
let count = 0;
const NONE: readonly Entry[] = [];

function remember(device: string, entry: Omit<Entry, "id" | "at">): void {
  count += 1;
  const before = history.get()[device] ?? NONE;
  history.set({ ...history.get(), [device]: [{ ...entry, id: count, at: new Date() }, ...before].slice(0, KEPT) });
}

interface Props {
  device: Device;
  connected: boolean;
  rows: readonly RegisterRow[];
  selected: RegisterRow | null;
  raw: number | null;
}

/** One datagram out, one back, past all checks: what you send is what the chip gets. */
export function ExchangeConsole({ device: whole, connected, rows, selected, raw }: Props) {
  const { id: device, about, link } = whole;
  const statusAlone = useLinkInfo(whole).data?.status_alone === true;
  const queries = useQueryClient();
  const wire = wireOf({ about, link });
  const entries = useShared(history)[device] ?? NONE;
  const [text, setText] = useState("");
  const back = useRef(-1);
  const frame = parseFrame(text, wire);
  const request = frame.ok ? decodeRequest(frame.bytes, wire, rows) : null;
  const send = useMutation({
    // one after the other: what is entered while a datagram is under way goes behind it
    scope: { id: `datagrams of ${device}` },
    mutationFn: (sent: string) =>
      api.POST("/api/v1/devices/{device}/exchange", { path: { device }, body: { frame: sent } }),
    onSuccess: (answer, sent) =>
      remember(device, {
        sent,
        reply: grouped(answer.reply),
        lines: decodedLines(answer.decoded, wire.dataBits),
        problem: null,
      }),
    onError: (error, sent) => remember(device, { sent, reply: null, lines: [], problem: problemOf(error) }),
    onSettled: () => {
      void queries.invalidateQueries({ queryKey: ["registers", device] });
    },
  });

  function recall(by: number) {
    back.current = Math.max(-1, Math.min(entries.length - 1, back.current + by));
    setText(entries[back.current]?.sent ?? "");
  }

  return (
    <div>
      <form
        aria-busy={send.isPending}
        onSubmit={(event) => {
          event.preventDefault();
          if (frame.ok && connected) {
            back.current = -1;
            send.mutate(frameText(frame.bytes));
          }
        }}
      >
        <Group gap="xs" wrap="nowrap" align="flex-end">
          <TextInput
            flex={1}
            label={`Datagram in hex, ${sizeText(wire)}`}
            placeholder={wire.example}
            classNames={{ input: "num" }}
            autoComplete="off"
            spellCheck={false}
            value={text}
            error={text.trim() !== "" && !frame.ok}
            aria-describedby="datagram-meaning"
            onChange={(event) => setText(event.currentTarget.value)}
            onKeyDown={(event) => {
              if (event.key !== "ArrowUp" && event.key !== "ArrowDown") return;
              event.preventDefault();
              recall(event.key === "ArrowUp" ? 1 : -1);
            }}
          />
          <Button type="submit" disabled={!frame.ok || !connected}>
            Send
          </Button>
        </Group>
        <Text
          id="datagram-meaning"
          size="xs"
          className={`room mt-4 ${text.trim() !== "" && !frame.ok ? "fault tight" : "dim"}`}
        >
          {request
            ? requestText(request, wire)
            : frame.ok || text.trim() === ""
              ? "It goes to the chip as it is: no range is checked."
              : frame.why}
        </Text>
      </form>
      {selected && (
        <Group gap={6} mt={6}>
          {readable(selected.access) && (
            <Button
              size="compact-xs"
              variant="default"
              onClick={() => setText(frameText(wire.frame(selected.address, true, 0)))}
            >
              Read {selected.name.length > 24 ? "the selected register" : selected.name}
            </Button>
          )}
          {writable(selected.access) && (
            <Button
              size="compact-xs"
              variant="default"
              onClick={() => setText(frameText(wire.frame(selected.address, false, raw ?? 0)))}
            >
              Write it
            </Button>
          )}
        </Group>
      )}
      {statusAlone && (
        <Button
          size="compact-xs"
          variant="default"
          mt={6}
          disabled={!connected}
          title="The chip sends its status first: eight clocks are enough, and it heeds nothing of what it gets"
          onClick={() => send.mutate(STATUS_ALONE)}
        >
          Status alone (8 clocks)
        </Button>
      )}
      {entries.length === 0 ? (
        <Text size="sm" className="dim" mt="md">
          Nothing sent yet. Type a datagram, or take one from the selected register.
          {connected ? "" : " The device is not connected."}
        </Text>
      ) : (
        <ol className="list mt-8 text-12" aria-label="Datagrams sent, newest first">
          {entries.map((entry) => (
            <li key={entry.id} className="rule-top py-4">
              <button
                type="button"
                className="plain lit lines-8 w-full"
                onClick={() => setText(entry.sent)}
                title="Use it again"
              >
                <span className="dim">{timeOf(entry.at)}</span>
                <span className="num">{entry.sent}</span>
                <span className="dim">{shortRequest(entry.sent, wire, rows)}</span>
              </button>
              {entry.problem ? (
                <Text size="xs" className="shrink fault tight">
                  {entry.problem.detail} {entry.problem.way_out}
                </Text>
              ) : (
                <div className="lines-8 anywhere">
                  <span className="num">← {entry.reply}</span>
                  {entry.lines.map(([name, line]) => (
                    <span key={name}>
                      <span className="dim">{name}</span> {line}
                    </span>
                  ))}
                </div>
              )}
            </li>
          ))}
        </ol>
      )}
    </div>
  );
}

function grouped(reply: string): string {
  return reply.replace(/\s/g, "").replace(/(..)(?=.)/g, "$1 ");
}

function requestText({ address, read, data, row }: Request, wire: Wire): string {
  const what = row ? `${row.name}${row.axis === null ? "" : ` of axis ${row.axis}`}` : "no register";
  return `${read ? "reads" : "writes"} ${hex(address, 8)}, ${what}${read ? "" : `: ${hex(data, wire.dataBits)}`}`;
}

function shortRequest(sent: string, wire: Wire, rows: readonly RegisterRow[]): string {
  if (sent === STATUS_ALONE) return "8 clocks";
  const frame = parseFrame(sent, wire);
  const request = frame.ok ? decodeRequest(frame.bytes, wire, rows) : null;
  return request ? `${request.read ? "read" : "write"} ${request.row?.name ?? "?"}` : "";
}
