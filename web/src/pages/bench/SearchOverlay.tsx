import type { Ref } from "react";
import type { Schemas } from "../../api/client";
import { fixed } from "../../lib/format";
import classes from "./bench.module.css";
import type { SeenEdge } from "./edges";

interface Props {
  search: Schemas["ReferenceSearchState"];
  /** what it has passed, in full steps of the counter */
  seen: readonly SeenEdge[];
  /** of a full step */
  microsteps: number;
  /** moved in every frame by what separates the counter's zero from the stage's */
  counted: Ref<SVGGElement>;
  /** where a count of full steps lies, but for that */
  place: (fullsteps: number) => number;
  left: number;
  width: number;
  /** height of the spindle */
  rail: number;
}

/** On the stage's drawing: the edges that a reference search has found, what it does, and where zero came to be. */
export function SearchOverlay({ search, seen, microsteps, counted, place, left, width, rail }: Props) {
  const running = search.state === "running";
  const done = search.state === "done";
  const base = rail + 46;
  return (
    <>
      <g ref={counted} data-testid="search-edges" data-edges={seen.length}>
        {seen.map((edge, index) => (
          <g
            // biome-ignore lint/suspicious/noArrayIndexKey: edges are only ever added
            key={index}
            data-last={running && index === seen.length - 1}
            className={classes.edge}
          >
            <path d={`M${place(edge.at)} ${rail - 28}V${rail + 22}`} />
            <title>{`${edge.which} switch ${edge.closed ? "closed" : "opened"} at ${fixed(edge.at, 1)} full steps`}</title>
          </g>
        ))}
        {hitsOf(search, microsteps).map((at, index) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: hits are only ever added
          <g key={index} className={classes.edge} data-testid="search-hit">
            <path d={`M${place(at)} ${rail - 28}V${rail + 22}`} />
            <title>{`hit ${index + 1} at ${fixed(at, 2)} full steps`}</title>
          </g>
        ))}
        {done && (
          <g>
            <path d={`M${place(0)} ${rail - 28}V${rail + 22}`} className="stroke-text stroke-1-5" />
            <text x={place(0)} y={rail - 51} textAnchor="middle" className="text-12 bold fill-text">
              0
            </text>
          </g>
        )}
      </g>
      <text x={left} y={base + 14} className={`text-12 ${search.state === "failed" ? "fill-fault" : "fill-text"}`}>
        {running ? runningText(search, seen) : done ? doneText(search) : search.message || search.state}
      </text>
      {running && (
        <g className={classes.searchProgress}>
          <rect x={left} y={base - 1} width={width} height={3} rx={1.5} />
          <rect x={left} y={base - 1} width={Math.max(3, width * search.progress)} height={3} rx={1.5} />
        </g>
      )}
    </>
  );
}

/** The hits of a search by stall, in full steps of the counter as it counts now. */
function hitsOf(search: Schemas["ReferenceSearchState"], microsteps: number): number[] {
  if (!search.stall) return [];
  const zero = search.state === "done" ? (search.last_position ?? 0) : 0;
  return search.edges.map((at) => (at - zero) / microsteps);
}

function runningText(search: Schemas["ReferenceSearchState"], seen: readonly SeenEdge[]): string {
  if (search.stall) return search.edges.length > 0 ? `${search.phase}; ${search.edges.length} hits` : search.phase;
  const last = seen.at(-1);
  return last ? `${search.phase}; ${last.which} switch ${last.closed ? "closed" : "opened"}` : search.phase;
}

function doneText(search: Schemas["ReferenceSearchState"]): string {
  const parts = [search.stall ? "Zero at the end of the stage" : "Zero found"];
  if (search.last_position !== null && search.last_position !== undefined)
    parts.push(`it was at ${fixed(search.last_position)} µsteps`);
  if (search.distance !== null && search.distance !== undefined)
    parts.push(`end switches ${fixed(search.distance)} µsteps apart`);
  return parts.join(", ");
}
