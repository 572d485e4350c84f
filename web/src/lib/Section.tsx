import { Paper, Text, VisuallyHidden } from "@mantine/core";
import { type PropsWithChildren, type ReactNode, useId } from "react";
import classes from "./Section.module.css";

interface Props {
  title: string;
  /** beside the title: a state, a unit */
  note?: ReactNode;
  /** at the right end of the title: buttons, a choice */
  actions?: ReactNode;
  className?: string | undefined;
}

/** A part of a page with its heading. */
export function Section({ title, note, actions, className, children }: PropsWithChildren<Props>) {
  const id = useId();
  return (
    <Paper component="section" withBorder aria-labelledby={id} className={`${classes.section} ${className ?? ""}`}>
      <header className={`${classes.header} lines-12 mb-4`}>
        <Text component="h2" id={id} className="text-14 bold tight">
          {title}
        </Text>
        {note !== undefined && <span className="hint">{note}</span>}
        {actions !== undefined && <div className="row wrap push gap-6">{actions}</div>}
      </header>
      {children}
    </Paper>
  );
}

/** A page of sections, with its name for those who do not see the navigation. */
export function Page({ name, children }: PropsWithChildren<{ name: string }>) {
  return (
    <div className="grid shrink gap-8">
      <VisuallyHidden>
        <h1>{name}</h1>
      </VisuallyHidden>
      {children}
    </div>
  );
}
