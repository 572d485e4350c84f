import { UnstyledButton, VisuallyHidden } from "@mantine/core";
import { useEffect, useRef, useState } from "react";
import { type Device, useDevices } from "../api/queries";
import { ConditionMark } from "../lib/condition/ConditionMark";
import { ConditionPopover } from "../lib/condition/ConditionPopover";
import classes from "../lib/condition/condition.module.css";
import { isBad, KINDS, sentence } from "../lib/condition/kinds";
import { conditions, type Kind } from "../live/conditions";
import { useSelection } from "../live/selection";
import { useStanding } from "../live/useStanding";

/** The condition of the selected axis, on every page; and whatever comes to be wrong with any axis, aloud. */
export function ConditionBar() {
  const { device, axis } = useSelection();
  const entry = device?.axes.find((candidate) => candidate.index === axis);
  return (
    <>
      <ConditionNews />
      {device && entry && <Bar key={`${device.id}/${axis}`} device={device} axis={entry} />}
    </>
  );
}

function Bar({ device, axis }: { device: Device; axis: Device["axes"][number] }) {
  const { condition } = useStanding(device.id, axis.index);
  return (
    <ConditionPopover
      device={device}
      axis={axis}
      target={(toggle, opened) => (
        <UnstyledButton
          className={`${classes.bar} inline shrink`}
          data-tone={KINDS[condition.kind].tone}
          data-testid="condition-bar"
          title={sentence(condition.cause)}
          aria-expanded={opened}
          onClick={toggle}
        >
          <ConditionMark kind={condition.kind} size={16} />
          <span className={`${classes.barCause} clip text-12`}>{condition.cause}</span>
        </UnstyledButton>
      )}
    />
  );
}

/** Says politely which axis has come to be in a bad condition. */
function ConditionNews() {
  const devices = useDevices();
  const names = useRef(devices.data);
  names.current = devices.data;
  const [news, setNews] = useState("");
  useEffect(() => {
    const before = new Map<string, Kind>();
    return conditions.subscribe(() => {
      for (const { device, axis, condition } of conditions.all()) {
        const key = `${device}/${axis}`;
        const known = before.get(key);
        before.set(key, condition.kind);
        if (known === undefined || known === condition.kind || !isBad(condition.kind)) continue;
        const of = names.current?.find(({ id }) => id === device);
        setNews(
          `${of?.name ?? device} ${of?.axes[axis]?.name ?? axis}: ${KINDS[condition.kind].word}. ${condition.cause}`,
        );
      }
    });
  }, []);
  return (
    <VisuallyHidden role="status" aria-live="polite" data-testid="condition-news">
      {news}
    </VisuallyHidden>
  );
}
