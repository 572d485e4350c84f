import { useEffect } from "react";
import { useCompareCount } from "../../rotary/useExtended";
import type { AxisRef } from "./model";

interface Props {
  at: AxisRef;
  onCount: (count: number | null) => void;
}

/** Says where the chip tells that the axis comes by. By itself: its numbers of 64 bits are for chips that compare. */
export function ComparedCount({ at, onCount }: Props) {
  const count = useCompareCount(at);
  useEffect(() => {
    onCount(count);
    return () => onCount(null);
  }, [count, onCount]);
  return null;
}
