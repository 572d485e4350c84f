import { Button } from "@mantine/core";
import css from "./rows.module.css";
import type { Staged } from "./store";

interface Props {
  count: number;
  staged: Staged;
  busy: boolean;
  canApply: boolean;
  onReview: () => void;
  onDiscard: () => void;
  onApply: () => void;
}

/** What waits and how the last Apply went, always in the same place. */
export function StagedBar({ count, staged, busy, canApply, onReview, onDiscard, onApply }: Props) {
  const waits = count > 0;
  return (
    <div
      className={`${css.bar} raised pad row box gap-8`}
      data-waits={waits}
      data-idle={!waits && staged.applied.length === 0}
    >
      <span className="mid lines-8 grow" role="status">
        {waits ? (
          <>
            <span className="count">{count}</span>
            {count === 1 ? "edit staged" : "edits staged"}
            {!canApply && ", waiting for the connection"}
          </>
        ) : (
          <span className="dim">{staged.applied.length === 0 && "No edits staged"}</span>
        )}
        <Outcome staged={staged} />
      </span>
      <Button size="compact-xs" variant="subtle" disabled={!waits && staged.applied.length === 0} onClick={onReview}>
        Review
      </Button>
      <Button size="compact-xs" variant="default" disabled={!waits || busy} onClick={onDiscard}>
        Discard all
      </Button>
      <Button size="compact-xs" loading={busy} disabled={!waits || !canApply} onClick={onApply}>
        Apply
      </Button>
    </div>
  );
}

function Outcome({ staged }: { staged: Staged }) {
  const failed = staged.edits.filter((edit) => edit.fate?.kind === "refused" || edit.fate?.kind === "differs").length;
  const untried = staged.edits.filter((edit) => edit.fate?.kind === "not tried").length;
  const verified = staged.applied.filter(({ written }) => written.verified === true).length;
  const sent = staged.applied.length - verified;
  const said = [
    verified > 0 && `${verified} read back`,
    sent > 0 && `${sent} written`,
    failed > 0 && `${failed} refused`,
    untried > 0 && `${untried} not tried`,
  ].filter(Boolean);
  if (said.length === 0) return null;
  return <span className={failed > 0 ? "fault text-12" : "hint"}>last apply: {said.join(", ")}</span>;
}
