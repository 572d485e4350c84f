import type { Group } from "../../../lib/rows/search";
import { type Edit, keyOf } from "../../../lib/rows/staging";
import css from "./parameters.module.css";

interface Props {
  groups: readonly Group[];
  edits: readonly Edit[];
  onJump: (key: string) => void;
}

/** The subjects in a strip: one click to each, and where edits wait. */
export function Subjects({ groups, edits, onJump }: Props) {
  if (groups.length < 2) return null;
  return (
    <nav className={`${css.subjects} flex wrap gap-4`} aria-label="Subjects">
      {groups.map((group) => {
        const staged = edits.filter((edit) => group.rows.some((row) => keyOf(row) === keyOf(edit))).length;
        return (
          <button
            key={group.key}
            type="button"
            className={`plain tag lit inline gap-4 pad-s raised nowrap`}
            onClick={() => onJump(group.key)}
          >
            {group.title}
            {staged > 0 && (
              <span className={`count`}>
                {staged}
                <span className="unseen"> staged</span>
              </span>
            )}
          </button>
        );
      })}
    </nav>
  );
}
