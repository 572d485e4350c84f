import { duration } from "../../../lib/format";
import { PIPED, type Start, TRIGGERS, WAITING } from "./start";
import classes from "./start.module.css";

const ROW = 30;
// as narrow as its texts allow: it stands whole, and not scaled below 12 px, in half a page of 1280
const WIDTH = 512;
const LEFT = { x: 2, width: 146 };
const MIDDLE = { x: 182, width: 124 };
const RIGHT = { x: 340, width: 170 };
const TOP = 12;

/** What triggers what: from the triggers over the delay to what waits for a start. */
export function StartPicture({ start }: { start: Start }) {
  const targets = [
    ...WAITING.map((name, n) => ({ name, on: start.waiting[n] === true })),
    ...PIPED.map((name, n) => ({ name: `pipeline: ${name}`, on: start.piped[n] === true })),
    { name: `pulse at START, ${duration(start.pulseS)}`, on: start.pin === "output" && start.triggers.includes(true) },
  ];
  const height = TOP * 2 + targets.length * ROW;
  const centre = height / 2;
  const any = start.triggers.includes(true);
  const leftAt = (n: number) => centre + (n - (TRIGGERS.length - 1) / 2) * 1.6 * ROW;
  const rightAt = (n: number) => TOP + n * ROW + ROW / 2;
  return (
    <svg
      viewBox={`0 0 ${WIDTH} ${height}`}
      className={classes.picture}
      role="img"
      aria-label={spoken(start, targets)}
      data-testid="start-picture"
    >
      {TRIGGERS.map((name, n) => {
        const on = start.triggers[n] === true;
        const delay = n === 0 ? start.pinDelayS : start.delayS;
        return (
          <g key={name} data-on={on}>
            <path
              className={classes.wire}
              d={`M${LEFT.x + LEFT.width} ${leftAt(n)} C ${MIDDLE.x - 18} ${leftAt(n)} ${MIDDLE.x - 22} ${centre} ${MIDDLE.x} ${centre}`}
            />
            <rect className={classes.box} x={LEFT.x} y={leftAt(n) - 17} width={LEFT.width} height={34} rx={4} />
            <text className={classes.name} x={LEFT.x + 8} y={leftAt(n) - 2}>
              {name}
            </text>
            <text className={classes.more} x={LEFT.x + 8} y={leftAt(n) + 12}>
              {on ? `after ${duration(delay)}` : "no trigger"}
            </text>
          </g>
        );
      })}
      <g data-on={any}>
        <rect className={classes.box} x={MIDDLE.x} y={centre - 24} width={MIDDLE.width} height={48} rx={4} />
        <text className={classes.name} x={MIDDLE.x + MIDDLE.width / 2} y={centre - 2} textAnchor="middle">
          start
        </text>
        <text className={classes.more} x={MIDDLE.x + MIDDLE.width / 2} y={centre + 14} textAnchor="middle">
          {start.busy ? "when no one is busy" : `START is an ${start.pin}`}
        </text>
      </g>
      {targets.map(({ name, on }, n) => (
        <g key={name} data-on={on && any}>
          <path
            className={classes.wire}
            d={`M${MIDDLE.x + MIDDLE.width} ${centre} C ${MIDDLE.x + MIDDLE.width + 22} ${centre} ${RIGHT.x - 22} ${rightAt(n)} ${RIGHT.x} ${rightAt(n)}`}
          />
          <rect className={classes.box} x={RIGHT.x} y={rightAt(n) - 12} width={RIGHT.width} height={24} rx={4} />
          <text className={classes.name} x={RIGHT.x + 8} y={rightAt(n) + 4}>
            {name}
          </text>
        </g>
      ))}
    </svg>
  );
}

function spoken(start: Start, targets: readonly { name: string; on: boolean }[]): string {
  const by = TRIGGERS.filter((_, n) => start.triggers[n]);
  const what = targets.filter(({ on }) => on).map(({ name }) => name);
  return `A start comes from ${by.join(", ") || "nothing"}, and does ${what.join(", ") || "nothing"}`;
}
