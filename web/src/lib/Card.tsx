import { type ComponentPropsWithoutRef, type ReactNode, useId } from "react";
import classes from "./Card.module.css";

interface Props extends Omit<ComponentPropsWithoutRef<"section">, "title"> {
  /** what it is to those who do not see its frame */
  as?: "section" | "aside" | "nav" | "div";
  /** its heading; without one it is a frame, and says by `aria-label` what it is */
  title?: string;
  /** beside the title: a state, a unit */
  note?: ReactNode;
  /** at the right end of the title: buttons, a choice */
  actions?: ReactNode;
}

/** A surface with a frame and, with a title, a heading: what every page is put together from. */
export function Card({ as: Tag = "section", title, note, actions, className = "", children, ...rest }: Props) {
  const id = useId();
  if (title === undefined)
    return (
      <Tag className={`card ${className}`} {...rest}>
        {children}
      </Tag>
    );
  return (
    <Tag className={`${classes.titled} card ${className}`} aria-labelledby={id} {...rest}>
      <header className={`${classes.header} lines-12 mid mb-4`}>
        <h2 id={id} className="m-0 text-14 bold tight">
          {title}
        </h2>
        {note !== undefined && <span className="hint">{note}</span>}
        {actions !== undefined && <div className="row wrap push gap-6">{actions}</div>}
      </header>
      {children}
    </Tag>
  );
}
