import { Text, UnstyledButton } from "@mantine/core";
import { IconChevronDown } from "@tabler/icons-react";
import { compact, fixed } from "../../../lib/format";
import { symbolOf } from "../../../lib/units";
import { LiveText } from "../../../live/LiveText";
import { type ScopeRow, type ScopeTrace, valueText } from "./model";
import classes from "./scope.module.css";
import type { Scope } from "./useScope";

interface Props {
  scopeRow: ScopeRow;
  scope: Scope;
  cursors: boolean;
  onToggle: (key: string) => void;
  /** none: its plot cannot be folded */
  onFold?: () => void;
}

function swatchOf(trace: ScopeTrace) {
  const { color, dash, width = 1 } = trace.series;
  return { borderTop: `${width > 1 ? 5 : 2}px ${dash ? "dashed" : "solid"} ${color}` };
}

/** The channels of one plot: colour, name, and the value now, at the pointer, or between the cursors. */
export function ChannelPanel({ scopeRow, scope, cursors, onToggle, onFold }: Props) {
  const { row, unit, traces } = scopeRow;
  const difference = (trace: ScopeTrace): string => {
    const { a, b } = scope.view.cursors();
    const delta = scope.valueAt(trace, b) - scope.valueAt(trace, a);
    return fixed(delta / trace.divisor, trace.decimals);
  };
  // as they lie on each other: what is drawn last is on top, and first in the list; lanes are listed from the top
  const listed =
    row.id === "switches"
      ? traces
      : [...traces.filter((trace) => trace.main).reverse(), ...traces.filter((trace) => !trace.main)];
  return (
    <div className={classes.panel} data-row={row.id}>
      <div className="flex between gap-6 mb-4">
        <Text component="h3" size="xs" fw={600}>
          {onFold ? (
            <UnstyledButton
              className="inline gap-2 text-12 bold"
              aria-expanded
              title={`Fold the plot: ${row.title}`}
              onClick={onFold}
            >
              {row.title}
              <IconChevronDown size={13} aria-hidden />
            </UnstyledButton>
          ) : (
            row.title
          )}
        </Text>
        <Text size="xs" c="dimmed">
          {symbolOf(unit)}
        </Text>
      </div>
      <ul className="list">
        {listed.map((trace) => (
          <li key={trace.key}>
            <UnstyledButton
              className={`${classes.channel} lit row gap-6 text-12 tight w-full`}
              aria-pressed={trace.shown}
              title={trace.shown ? `Hide ${trace.label}` : `Show ${trace.label}`}
              onClick={() => onToggle(trace.key)}
            >
              <span className={classes.swatch} style={swatchOf(trace)} />
              <span className={`${classes.channelName} clip grow shrink`}>{trace.label}</span>
              <LiveText
                className={`${classes.channelValue} text-12 mono right nowrap`}
                data-channel={trace.channel}
                read={() => valueText(trace, scope.valueAt(trace, scope.hover()))}
              />
            </UnstyledButton>
            {cursors && trace.shown && trace.measured && (
              <div className={`indent hint flex between`}>
                <span>B − A</span>
                <LiveText
                  className={`${classes.channelValue} text-12 mono right nowrap`}
                  read={() => difference(trace)}
                />
              </div>
            )}
          </li>
        ))}
      </ul>
    </div>
  );
}

/** The distance in time between the cursors, and what frequency that is. */
export function CursorReadout({ scope }: { scope: Scope }) {
  const distance = () => {
    const { a, b } = scope.view.cursors();
    return b - a;
  };
  return (
    <div className={`${classes.cursorReadout} under-plot lines-8 baseline text-12`} data-testid="cursor-readout">
      <span style={{ color: scope.markColors.a, fontWeight: 700 }}>A</span>
      <LiveText read={() => fixed(scope.view.cursors().a, 4, "s")} />
      <span style={{ color: scope.markColors.b, fontWeight: 700 }}>B</span>
      <LiveText read={() => fixed(scope.view.cursors().b, 4, "s")} />
      <span>Δt</span>
      <LiveText read={() => fixed(distance() * 1000, 2, "ms")} />
      <span>1/Δt</span>
      <LiveText read={() => compact(1 / Math.abs(distance()), 4, "Hz")} />
    </div>
  );
}
