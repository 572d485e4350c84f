import { useEffect, useRef } from "react";
import type { Device } from "../../../api/queries";
import { useFrame } from "../../../live/useFrame";
import { useTelemetry } from "../../../live/useTelemetry";
import type { Seen } from "./seen";
import { phasesOf, type Table } from "./wave";

interface Props {
  device: Device;
  axis: number;
  held: Table;
  seen: Seen;
  /** told a few times a second, when there is something new */
  onCount: (places: number, wrong: number) => void;
}

/** A prime, so that no round velocity is in step with it and shows the same positions again and again. */
const RATE_HZ = 397;
const KEEP_S = 10;
/** Samples on their way while a wave is written belong to the one before: that long, and twice what the wire is late [s]. */
const SETTLE_S = 0.3;
/** Positions that may pass between the readings of one sample, where they follow one another on a wire. */
const APART = 8;
const TOLD_EVERY_MS = 300;

/** Collects what the chip shows of its wave while the motor turns. */
export function Watch({ device, axis, held, seen, onCount }: Props) {
  const sine = phasesOf(device.about.family, device.model).sine === "CUR_B" ? "b" : "a";
  const channels = ["mscnt", `current_${sine}`, `current_${sine === "a" ? "b" : "a"}`].map((each) => `${each}.${axis}`);
  const { buffer, link } = useTelemetry(device.id, channels, Math.min(RATE_HZ, device.rate_max_hz), KEEP_S);
  const from = useRef(Number.NaN);
  const lateS = useRef(0);
  lateS.current = (link.latencyMs ?? 0) / 1000;
  const told = useRef({ atMs: 0, revision: 0 });
  const words = held.registers.map((row) => row.hex).join();

  // biome-ignore lint/correctness/useExhaustiveDependencies: another wave begins anew, however it came about
  useEffect(() => {
    seen.clear();
    from.current = buffer.lastTime + SETTLE_S + 2 * lateS.current;
    onCount(0, 0);
  }, [words, buffer, seen, onCount]);

  useFrame((nowMs) => {
    if (buffer.length === 0) return;
    // before the first frame there was no time to begin at; what is older may be of another wave
    if (Number.isNaN(from.current)) from.current = buffer.lastTime;
    const times = buffer.times();
    const [positions, a, b] = channels.map((channel) => buffer.column(channel));
    for (let row = times.length - 1; row >= 0 && (times[row] as number) > from.current; row--) {
      seen.add(
        positions?.[row] ?? Number.NaN,
        a?.[row] ?? Number.NaN,
        b?.[row] ?? Number.NaN,
        held,
        device.chip_timed ? 0 : APART,
      );
    }
    from.current = Math.max(from.current, buffer.lastTime);
    if (told.current.revision !== seen.revision && nowMs - told.current.atMs > TOLD_EVERY_MS) {
      told.current = { atMs: nowMs, revision: seen.revision };
      onCount(seen.places, seen.wrong);
    }
  });
  return null;
}
