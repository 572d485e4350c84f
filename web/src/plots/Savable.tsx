import { type ReactNode, useRef } from "react";
import { SaveButton } from "./SaveButton";

interface Props {
  name: string;
  className?: string | undefined;
  /** see `SaveButton` */
  low?: boolean;
  children: ReactNode;
}

/** Around a drawing of data in SVG, and its legend where that is a `figcaption`: has the button that saves both. */
export function Savable({ name, className = "", low, children }: Props) {
  const frame = useRef<HTMLDivElement>(null);
  return (
    <div ref={frame} className={`${className} relative`}>
      {children}
      <SaveButton name={name} low={low} subject={() => frame.current && { title: name, frame: frame.current }} />
    </div>
  );
}
