import { type ComponentPropsWithoutRef, useEffect, useLayoutEffect, useRef } from "react";
import { repeatFrames } from "./useFrame";

interface Props extends Omit<ComponentPropsWithoutRef<"span">, "children"> {
  /** what to show now; asked about fifteen times a second, outside of React's rendering */
  read: () => string;
}

const PERIOD_MS = 66; // faster, nobody reads digits; slower, they stutter

/** Run `update` with all live texts of the page, after the plots of a frame. Returns the function that ends it. */
export function everyTick(update: () => void): () => void {
  return repeatFrames(update, () => PERIOD_MS, "texts");
}

/**
 * Text that follows live samples without rendering: only its text node changes. What is rendered beside it never stands
 * beside the text of before: a rendering brings it up to date at once, however late the next animation frame is.
 */
export function LiveText({ read, className, ...rest }: Props) {
  const span = useRef<HTMLSpanElement>(null);
  const latest = useRef(read);
  latest.current = read;
  const write = () => {
    const text = latest.current();
    const node = span.current;
    if (node && node.textContent !== text) node.textContent = text;
  };
  const latestWrite = useRef(write);
  useLayoutEffect(write);
  useEffect(() => everyTick(latestWrite.current), []);
  return <span ref={span} className={className ?? "num"} {...rest} />;
}
