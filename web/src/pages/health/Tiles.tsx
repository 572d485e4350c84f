import { Progress } from "@mantine/core";
import type { ReactNode } from "react";
import { fixed, sizeText } from "../../lib/format";
import { sparklines, type Tone, toneOf, toneOfLag, topOf, usedPercent } from "./figures";
import classes from "./health.module.css";
import type { Health } from "./useHealth";

const COLOURS: Readonly<Record<Tone, string>> = { well: "accent", soon: "orange", bad: "red" };
const WORDS: Readonly<Record<Tone, string>> = { well: "", soon: ", nearly used up", bad: ", used up" };

/** The server's own figures: those that have an end as bars, the event loop's lateness as a line. */
export function Tiles({ health }: { health: Health }) {
  const { storage, process, event_loop: loop, sockets } = health;
  const used =
    storage.total_bytes === null || storage.free_bytes === null ? null : storage.total_bytes - storage.free_bytes;
  return (
    <div className={classes.tiles}>
      <LagTile loop={loop} />
      <Bar
        name="Disk of the data directory"
        value={`${sizeText(storage.free_bytes)} free`}
        percent={usedPercent(used, storage.total_bytes)}
        more={`of ${sizeText(storage.total_bytes)}, ${sizeText(storage.reserve_bytes)} not for recordings · ${storage.data_dir}`}
      />
      <Bar
        name="Descriptors"
        value={`${fixed(process.descriptors)} open`}
        percent={usedPercent(process.descriptors, process.descriptors_max)}
        more={`of ${fixed(process.descriptors_max)}: files, links and connections`}
      />
      <Bar
        name="Connections"
        value={fixed(sockets.connections)}
        percent={usedPercent(sockets.connections, sockets.connections_max)}
        more={`of ${fixed(sockets.connections_max)} · ${fixed(sockets.websockets)} ${sockets.websockets === 1 ? "WebSocket" : "WebSockets"} · ${fixed(sockets.connections_ended)} ended · ${fixed(sockets.rows_dropped)} rows dropped for slow readers`}
      />
      <Tile name="Memory" value={sizeText(process.resident_bytes)} more="resident" />
    </div>
  );
}

function Tile({ name, value, more, children }: { name: string; value: string; more: string; children?: ReactNode }) {
  return (
    <div className={`column gap-4`}>
      <h3 className="hint m-0 bold">{name}</h3>
      <div className="text-16 bold tight">{value}</div>
      {children}
      <div className="hint anywhere">{more}</div>
    </div>
  );
}

function Bar({ name, value, percent, more }: { name: string; value: string; percent: number | null; more: string }) {
  const tone = toneOf(percent);
  return (
    <Tile name={name} value={value} more={more}>
      <Progress
        value={percent ?? 0}
        color={COLOURS[tone]}
        size={8}
        aria-label={`${name}: ${percent === null ? "not known" : `${fixed(percent, 0, "%")} used${WORDS[tone]}`}`}
      />
    </Tile>
  );
}

const WIDTH = 240;
const HEIGHT = 40;

function LagTile({ loop }: { loop: Health["event_loop"] }) {
  const values = loop.lag_ms_by_second;
  const top = topOf(values);
  const p99 = fixed(loop.lag_p99_ms, 1, "ms");
  return (
    <Tile
      name="Event loop late by"
      value={fixed(loop.lag_ms, 1, "ms")}
      more={`99 of 100 in the last minute: ${p99} at most · top of the line: ${fixed(top, 0, "ms")}`}
    >
      <svg
        className={classes.spark}
        data-tone={toneOfLag(loop.lag_p99_ms)}
        viewBox={`0 0 ${WIDTH} ${HEIGHT}`}
        preserveAspectRatio="none"
        role="img"
        aria-label={`The worst of each of the last 60 seconds; 99 of 100 at most ${p99}`}
      >
        {sparklines(values, top, WIDTH, HEIGHT).map((points) => (
          <polyline key={points} points={points} />
        ))}
      </svg>
    </Tile>
  );
}
