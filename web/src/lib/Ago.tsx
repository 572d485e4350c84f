import { useInterval } from "@mantine/hooks";
import { useEffect, useState } from "react";
import { agoText, fullTimeOf } from "./time";

const STEP_MS = 20_000;

/** How long ago something was, going on by itself; within a day of it. The whole time where it is pointed at. */
export function Ago({ unixS }: { unixS: number | null }) {
  const [nowMs, setNow] = useState(Date.now);
  const { start, stop } = useInterval(() => setNow(Date.now()), STEP_MS);
  useEffect(() => {
    start();
    return stop;
  }, [start, stop]);
  if (unixS === null) return <>–</>;
  const at = unixS * 1000;
  return (
    <time className="nowrap" dateTime={new Date(at).toISOString()} title={fullTimeOf(at)}>
      {agoText(at, Math.max(nowMs, Date.now()))}
    </time>
  );
}
