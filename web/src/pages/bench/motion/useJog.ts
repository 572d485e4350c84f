import { type KeyboardEvent, type PointerEvent, useCallback, useEffect, useMemo, useRef, useState } from "react";
import { problemOf } from "../../../api/client";
import { leaseClient } from "../../../api/lease/bench";
import { ONLY_LOOKING } from "../../../api/lease/gate";
import { type AxisAddress, motion } from "../../../api/motion";
import { STOP_EVENT } from "../../../shell/stopEverything";
import { type Direction, HOLD_S, Jog } from "./Jog";

function keyDirection(key: string, own: Direction): Direction | null {
  if (key === "ArrowLeft") return -1;
  if (key === "ArrowRight") return 1;
  return key === " " || key === "Enter" ? own : null;
}

const notSent = (error: unknown) => problemOf(error).type === ONLY_LOOKING;

/** The handlers of a pair of jog buttons. Letting go stops, and so does all that may hide that the user let go. */
export function useJog(at: AxisAddress, velocityPps: number, onError: (error: unknown) => void) {
  const [direction, setDirection] = useState<Direction | null>(null);
  const speed = useRef(velocityPps);
  speed.current = velocityPps;
  const report = useRef(onError);
  report.current = onError;
  const { device, axis } = at;
  const jog = useMemo(
    () =>
      new Jog(
        (sign) => motion.jog({ device, axis }, { velocity: sign * speed.current, unit: "pps", hold_s: HOLD_S }),
        () => motion.keepRotating({ device, axis }, { hold_s: HOLD_S }),
        () => motion.stop({ device, axis }, "ramp"),
        (error) => (notSent(error) ? void leaseClient.permitHeld() : report.current(error)),
        setDirection,
        notSent,
      ),
    [device, axis],
  );

  const pressed = useRef<Direction | null>(null);
  const letGo = useCallback(() => {
    pressed.current = null;
    jog.release();
  }, [jog]);

  useEffect(() => {
    const release = () => letGo();
    const onHidden = () => document.hidden && letGo();
    window.addEventListener("blur", release);
    window.addEventListener("pagehide", release);
    window.addEventListener(STOP_EVENT, release);
    document.addEventListener("visibilitychange", onHidden);
    return () => {
      letGo();
      window.removeEventListener("blur", release);
      window.removeEventListener("pagehide", release);
      window.removeEventListener(STOP_EVENT, release);
      document.removeEventListener("visibilitychange", onHidden);
    };
  }, [letGo]);

  // Before anything is held: the question takes the focus, and what lets go for that would stop another's motor. What
  // was let go while the free bench was taken does not move any more.
  const press = async (wanted: Direction) => {
    pressed.current = wanted;
    if ((await leaseClient.permitHeld()) && pressed.current === wanted) jog.press(wanted);
  };

  const buttonProps = (own: Direction) => ({
    onPointerDown: (event: PointerEvent<HTMLButtonElement>) => {
      if (event.button !== 0) return;
      event.currentTarget.setPointerCapture(event.pointerId);
      event.currentTarget.focus();
      void press(own);
    },
    onPointerUp: () => letGo(),
    onPointerCancel: () => letGo(),
    onLostPointerCapture: () => letGo(),
    onBlur: () => letGo(),
    onContextMenu: (event: { preventDefault: () => void }) => event.preventDefault(), // a long touch is a jog, no menu
    onKeyDown: (event: KeyboardEvent) => {
      const wanted = keyDirection(event.key, own);
      if (wanted === null) return;
      event.preventDefault();
      if (!event.repeat) void press(wanted);
    },
    onKeyUp: (event: KeyboardEvent) => {
      if (keyDirection(event.key, own) !== null) letGo();
    },
  });

  return { direction, buttonProps };
}
