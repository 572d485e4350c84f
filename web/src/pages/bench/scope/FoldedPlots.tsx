import { UnstyledButton } from "@mantine/core";
import { IconChevronRight } from "@tabler/icons-react";
import { symbolOf } from "../../../lib/units";
import { LiveText } from "../../../live/LiveText";
import { type ScopeRow, valueText } from "./model";
import type { RowId } from "./rows";
import classes from "./scope.module.css";
import type { Scope } from "./useScope";

interface Props {
  rows: readonly ScopeRow[];
  scope: Scope;
  onOpen: (id: RowId) => void;
}

/** The plots that there is no room for: each by its name and its value, and a press opens it. */
export function FoldedPlots({ rows, scope, onOpen }: Props) {
  return (
    <div className="lines-4 rigid" data-testid="folded-plots">
      {rows.map(({ row, unit, traces }) => {
        const trace = traces.find((candidate) => candidate.measured && candidate.shown);
        return (
          <UnstyledButton
            key={row.id}
            className={`${classes.folded} lit inline box gap-6 text-12`}
            aria-expanded={false}
            title={`Show the plot: ${row.title}`}
            onClick={() => onOpen(row.id)}
          >
            <IconChevronRight size={14} aria-hidden />
            <span className="bold">{row.title}</span>
            {trace && (
              <>
                <LiveText
                  className={`${classes.channelValue} text-12 mono right nowrap`}
                  read={() => valueText(trace, scope.valueAt(trace, scope.hover()))}
                />
                <span className="dim">{symbolOf(unit)}</span>
              </>
            )}
          </UnstyledButton>
        );
      })}
    </div>
  );
}
