import { Skeleton } from "@mantine/core";
import type { Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { type LinkInfo, useLinkInfo } from "../../lib/wire/useLinkInfo";
import { WireBar } from "../../lib/wire/WireBar";
import css from "./console.module.css";
import { clock } from "./log";

/** What the wire could carry, what it carries, and what went wrong on it. */
export function WirePanel({ device }: { device: Device }) {
  const link = useLinkInfo(device);
  return (
    <Card title="Wire" note={link.data ? wireText(link.data) : undefined}>
      {link.isError && <ProblemAlert error={link.error} doing="Looking at the wire" />}
      {link.isPending && device.state === "connected" && <Skeleton height={40} radius="sm" aria-hidden />}
      {device.state === "disconnected" && <p className="m-0 dim">Not connected: nothing goes over it.</p>}
      {link.data && (
        <div className="stack gap-6">
          <div>
            <WireBar link={link.data} old={device.state !== "connected"} />
          </div>
          <dl className="facts lines-16 m-0 text-12">
            {countsOf(link.data).map(([word, count]) => (
              <div key={word}>
                <dt>{word}</dt>
                <dd className="num">{fixed(count)}</dd>
              </div>
            ))}
          </dl>
          {link.data.shared_with.length > 0 && (
            <p className="m-0 dim">Shared with {link.data.shared_with.join(", ")}: one transaction at a time.</p>
          )}
          <Incidents link={link.data} />
        </div>
      )}
    </Card>
  );
}

function wireText(link: LinkInfo): string {
  return link.baud === null ? link.kind : `${link.kind}, ${fixed(link.baud)} baud`;
}

function countsOf({ counts }: LinkInfo): [string, number][] {
  return [
    ["stops", counts.stops],
    ["commands", counts.commands],
    ["samples", counts.samples],
    ["samples dropped", counts.samples_dropped],
    ["timeouts", counts.timeouts],
    ["failures", counts.failures],
  ];
}

function Incidents({ link }: { link: LinkInfo }) {
  if (link.incidents.length === 0) return <p className="m-0 dim">No incident on this wire.</p>;
  return (
    <ul className={`${css.incidents} list text-12 scroll`} aria-label="Incidents, newest first">
      {link.incidents.slice(0, 50).map((incident) => (
        <li key={`${incident.time_unix_s} ${incident.kind}`} className="lines-8 rule-top">
          <span className="num">{clock(incident.time_unix_s)}</span>
          <b className="caution bold">{incident.kind.replaceAll("_", " ")}</b>
          <span>{incident.text}</span>
        </li>
      ))}
    </ul>
  );
}
