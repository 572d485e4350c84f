import { Text } from "@mantine/core";
import { useMemo, useRef, useState } from "react";
import { Card } from "../../lib/Card";
import { Loading } from "../../lib/Loading";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { AuditEntries } from "../../pages/audit/AuditEntries";
import { useAudit } from "../../pages/audit/useAudit";
import type { DeviceProps } from "../panel";
import css from "../workspace.module.css";

/** Scrolled down further than that, rows are read: new ones wait above. */
const READING_PX = 40;

/** What was done to the device, and by whom, as it happens. */
export function LogPanel({ device }: DeviceProps) {
  const audit = useAudit(useMemo(() => ({ device: device.id }), [device.id]));
  const [reading, setReading] = useState(false);
  const list = useRef<HTMLElement>(null);
  return (
    <Card title="Log" note={audit.stale ? "no news: the server does not answer" : device.name} className="stack grow">
      {audit.error !== null && <ProblemAlert error={audit.error} doing="Reading the log" retry={audit.again} />}
      <section
        ref={list}
        className={css.log}
        onScroll={(event) => setReading(event.currentTarget.scrollTop > READING_PX)}
        // biome-ignore lint/a11y/noNoninteractiveTabindex: what scrolls has to be reached by the keyboard
        tabIndex={0}
        aria-label={`Log of ${device.name}`}
      >
        {audit.entries === undefined ? (
          audit.error === null && <Loading label="Reading the log" />
        ) : audit.entries.length + audit.news.length === 0 ? (
          <Text size="sm" className="dim">
            Nothing was done to {device.name} yet.
          </Text>
        ) : (
          <AuditEntries
            audit={audit}
            asking={audit.asking}
            reading={reading}
            toTop={() => list.current?.scrollTo({ top: 0 })}
          />
        )}
      </section>
    </Card>
  );
}
