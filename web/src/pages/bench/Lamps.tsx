import { useEffect, useRef } from "react";
import { can, type Device } from "../../api/queries";
import { everyTick } from "../../live/LiveText";
import classes from "./bench.module.css";
import type { AxisQuantity, LiveAxis } from "./live";

const LAMPS: readonly [AxisQuantity, letter: string, name: string][] = [
  ["switch_left", "L", "left switch"],
  ["switch_home", "H", "home switch"],
  ["switch_right", "R", "right switch"],
];

function Lamp({
  live,
  quantity,
  letter,
  name,
}: {
  live: LiveAxis;
  quantity: AxisQuantity;
  letter: string;
  name: string;
}) {
  const lamp = useRef<HTMLSpanElement>(null);
  useEffect(
    () =>
      everyTick(() => {
        const value = live.read(quantity);
        const state = Number.isNaN(value) ? "unknown" : value > 0.5 ? "on" : "off";
        const node = lamp.current;
        if (!node || node.dataset.state === state) return;
        node.dataset.state = state;
        node.setAttribute("aria-label", `${name} ${state}`);
      }),
    [live, quantity, name],
  );
  return (
    <span
      ref={lamp}
      className={`${classes.lamp} hint bold`}
      data-state="unknown"
      role="img"
      aria-label={`${name} unknown`}
      title={name}
    >
      {letter}
    </span>
  );
}

/** The switches of an axis: lit while active. */
export function Lamps({ live, device }: { live: LiveAxis; device: Device }) {
  return (
    <span className={classes.lamps}>
      {LAMPS.filter(([quantity]) => can(device, "home_switch") || quantity !== "switch_home").map(
        ([quantity, letter, name]) => (
          <Lamp key={quantity} live={live} quantity={quantity} letter={letter} name={name} />
        ),
      )}
    </span>
  );
}
