import type { Kind } from "../../live/conditions";
import classes from "./condition.module.css";
import { KINDS } from "./kinds";

interface Props {
  kind: Kind;
  size?: number;
}

/** A condition in one word, with its icon and shade. */
export function ConditionMark({ kind, size = 14 }: Props) {
  const { word, tone, Icon } = KINDS[kind];
  return (
    <span
      className={`${classes.mark} inline shrink gap-4 text-12 bold tight nowrap`}
      data-tone={tone}
      data-kind={kind}
      data-testid="condition"
    >
      <Icon size={size} stroke={2} aria-hidden />
      <span className="clip">{word}</span>
    </span>
  );
}
