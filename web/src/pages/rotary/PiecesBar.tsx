import { Button, Progress, Text, VisuallyHidden } from "@mantine/core";
import { IconPlayerStop } from "@tabler/icons-react";
import { Card } from "../../lib/Card";
import { compact, percent } from "../../lib/format";
import { grouped } from "./exact";
import { longTime, type PiecesView, type Segment } from "./pieces";
import classes from "./rotary.module.css";

interface Props {
  view: PiecesView | null;
  /** of a piece [microsteps] */
  length: bigint;
  /** still to go [microsteps], [deg of the shaft] */
  left: bigint;
  leftTurns: number | null;
  timeLeftS: number | null;
  pps: number | null;
  moving: boolean;
  stopping: boolean;
  onStop: () => void;
  disabled: boolean;
}

const STATES: Record<Segment["state"], string> = { done: "done", underway: "under way", left: "to come" };

/** The pieces of a move that is longer than the chip's own counter can tell, as it is given them. */
export function PiecesBar({
  view,
  length,
  left,
  leftTurns,
  timeLeftS,
  pps,
  moving,
  stopping,
  onStop,
  disabled,
}: Props) {
  const pieces = (count: number) => `${compact(count)} ${count === 1 ? "piece" : "pieces"}`;
  return (
    <Card
      title="Move in pieces"
      note={view && view.total > 0 ? `each up to ${grouped(length)} µsteps` : `a piece is ${grouped(length)} µsteps`}
      actions={
        <Button
          color="red"
          variant={moving ? "filled" : "light"}
          leftSection={<IconPlayerStop size={16} aria-hidden />}
          onClick={onStop}
          loading={stopping}
          disabled={disabled}
          data-testid="stop-move"
        >
          Stop
        </Button>
      }
    >
      {view === null || view.total === 0 ? (
        <Text className="hint" role="status">
          {moving
            ? "The move is in one piece."
            : "Nothing under way. A move longer than a piece is shown here, piece by piece."}
        </Text>
      ) : (
        <>
          <Progress value={Math.round(view.progress * 1000) / 10} aria-label="The whole move" size={4} mb={6} />
          <ol className="list row wrap gap-2" aria-label="Pieces" data-testid="pieces">
            {view.before > 0 && <li className="hint nowrap px-4">{pieces(view.before)} before</li>}
            {view.segments.map((segment) => (
              <li key={segment.index} className={`${classes.piece} shrink relative hidden`} data-state={segment.state}>
                <span className={classes.pieceFill} style={{ width: `${segment.share * 100}%` }} />
                <span
                  className={`${classes.pieceName} center text-12 mono relative ${segment.state === "underway" ? "bold" : ""}`}
                >
                  {segment.index + 1}
                  <VisuallyHidden> {STATES[segment.state]}</VisuallyHidden>
                </span>
              </li>
            ))}
            {view.after > 0 && <li className="hint nowrap px-4">{pieces(view.after)} more</li>}
          </ol>
          <dl className="facts lines-16 m-0 mt-8 text-12">
            <div>
              <dt>done</dt>
              <dd className="num" data-testid="pieces-done">
                {compact(view.done)} of {compact(view.total)}
              </dd>
            </div>
            <div>
              <dt>whole way</dt>
              <dd className="num">{percent(view.progress, view.progress < 0.1 ? 2 : 1)}</dd>
            </div>
            <div>
              <dt>to go</dt>
              <dd className="num" data-testid="distance-left">
                {grouped(left)} µsteps
              </dd>
            </div>
            {leftTurns !== null && (
              <div>
                <dt>in turns</dt>
                <dd className="num">{compact(leftTurns, 5)}</dd>
              </div>
            )}
            <div>
              <dt>time left</dt>
              <dd className="num" data-testid="time-left">
                {moving ? longTime(timeLeftS) : "–"}
              </dd>
            </div>
            <div>
              <dt>at</dt>
              <dd className="num">{pps === null ? "–" : compact(Math.round(Math.abs(pps)))} pps</dd>
            </div>
          </dl>
        </>
      )}
    </Card>
  );
}
