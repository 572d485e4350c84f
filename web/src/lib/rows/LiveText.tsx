import { useRef } from "react";

interface Props {
  text: string;
  className?: string | undefined;
}

/** A text that lights up when it changes. The first one is no change. */
export function LiveText({ text, className = "" }: Props) {
  const first = useRef(text);
  const changed = useRef(false);
  if (text !== first.current) changed.current = true;
  // A new key restarts the animation, also when the last one still runs.
  return (
    <span key={text} className={`${className} ${changed.current ? "changed" : ""}`}>
      {text}
    </span>
  );
}
