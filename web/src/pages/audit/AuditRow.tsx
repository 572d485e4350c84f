import { UnstyledButton } from "@mantine/core";
import { IconBan, IconHelpCircle } from "@tabler/icons-react";
import { memo } from "react";
import { Link } from "wouter";
import type { Device } from "../../api/queries";
import { openHistory, withoutChange } from "../../lib/history/aim";
import { fullTimeOf } from "../../lib/time";
import { pageAbout } from "../../shell/pages";
import classes from "./audit.module.css";
import type { Entry } from "./filters";
import { detailText, hasFields, outcomeOf, timeText, valueText } from "./words";

interface Props {
  entry: Entry;
  /** the device it was done to, where there is one of that name now */
  device: Device | undefined;
  onSelect: (device: string, axis: number) => void;
}

/** What registers tell of. */
const UNDONE = new Set(["write", "apply profile", "undo", "start up", "write table"]);

/** One entry; on a phone two lines. */
export const AuditRow = memo(function AuditRow({ entry, device, onSelect }: Props) {
  const { kind, why } = outcomeOf(entry);
  const axis = entry.axis === null ? "" : (device?.axes[entry.axis]?.name ?? `axis ${entry.axis}`);
  const many = device === undefined || device.axes.length > 1;
  const fields = hasFields(entry);
  const [old, now] = [valueText(entry.old), valueText(entry.new)];
  return (
    <tr data-outcome={kind} data-testid="audit-entry">
      <td className="num nowrap">
        <time dateTime={entry.time} title={fullTimeOf(Date.parse(entry.time))}>
          {timeText(entry.time)}
        </time>
      </td>
      <td className={classes.who} title={[entry.kind, entry.address].filter(Boolean).join(", ")}>
        {entry.who}
      </td>
      <td className={classes.device}>
        {entry.device ?? ""} {many && axis !== "" && <span className={`${classes.dim} dim`}>{axis}</span>}
      </td>
      <td className="nowrap">{entry.action}</td>
      <td className={classes.what}>
        <Subject entry={entry} device={device} onSelect={onSelect} />
        {entry.detail !== "" && (
          <span className={`${entry.subject === "" ? "" : "ml-8"} dim`}>{detailText(entry.detail)}</span>
        )}
      </td>
      <td className={`num ${classes.values}`} title={fields ? `${old} → ${now}` : undefined}>
        {!fields && (old !== "" || now !== "") && (
          <>
            {old !== "" && <span className={`${classes.dim} dim`}>{old} </span>}
            <span className={`${classes.dim} dim`}>→ </span>
            {now === "" ? <span className={`${classes.dim} dim`}>nothing</span> : now}
          </>
        )}
      </td>
      <td className={classes.outcome}>
        {kind === "done" ? (
          <span className={`${classes.dim} dim`}>done</span>
        ) : (
          <b className="inline gap-4 nowrap">
            {kind === "refused" ? <IconBan size={13} aria-hidden /> : <IconHelpCircle size={13} aria-hidden />} {kind}
          </b>
        )}
        {device && kind !== "refused" && UNDONE.has(entry.action) && (
          <UnstyledButton
            className="accent text-12 ml-8"
            aria-label={`Undo ${entry.action} ${entry.subject}`}
            title="See what putting it back would write"
            onClick={() => openHistory(withoutChange(device.id, entry.id, `${entry.action} ${entry.subject}`.trim()))}
          >
            undo
          </UnstyledButton>
        )}
        {why !== "" && <span className={`${classes.why} dim`}>{why}</span>}
      </td>
    </tr>
  );
});

function Subject({ entry, device, onSelect }: Props) {
  if (entry.action !== "write" || device === undefined) return <>{entry.subject}</>;
  const page = pageAbout("settings", device.about.capabilities)?.path ?? "/registers";
  return (
    <Link
      href={`${page}?find=${encodeURIComponent(entry.subject)}`}
      className="accent"
      onClick={() => onSelect(device.id, entry.axis ?? 0)}
    >
      {entry.subject}
    </Link>
  );
}
