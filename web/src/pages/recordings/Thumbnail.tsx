import { useInViewport } from "@mantine/hooks";
import { useQuery } from "@tanstack/react-query";
import { useMemo } from "react";
import { coordinate } from "../../lib/format";
import { useScheme } from "../../lib/useScheme";
import { fetchPiece, isRunning, type Recording } from "./api";
import { lanesOf } from "./channels";
import classes from "./recordings.module.css";
import type { Piece } from "./ZoomData";

const WIDTH = 120;
const HEIGHT = 26;

/** The line of a column of a piece, over the whole of the drawing; empty where there is nothing to see. */
export function sparkline({ x, columns }: Pick<Piece, "x" | "columns">, column: number): string {
  const values = columns[column] ?? new Float64Array();
  let [low, high] = [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  const [first, last] = [x[0] ?? 0, x.at(-1) ?? 0];
  if (!(last > first) || !(high >= low)) return "";
  const perX = WIDTH / (last - first);
  const perY = high > low ? (HEIGHT - 4) / (high - low) : 0;
  const bottom = high > low ? HEIGHT - 2 : HEIGHT / 2;
  let path = "";
  let pen = false;
  values.forEach((value, row) => {
    const drawn = !Number.isNaN(value);
    if (drawn) {
      const place = `${coordinate(((x[row] ?? 0) - first) * perX, 1)} ${coordinate(bottom - (value - low) * perY, 1)}`;
      path += `${pen ? "L" : "M"}${place}`;
    }
    pen = drawn;
  });
  return path;
}

/** What a recording looks like: the uppermost of its plots, small. Asked for when it comes into sight. */
export function Thumbnail({ recording }: { recording: Recording }) {
  const scheme = useScheme();
  const { ref, inViewport } = useInViewport<HTMLDivElement>();
  const { id, channels, rows, device } = recording;
  const lane = useMemo(() => lanesOf(channels, scheme)[0], [channels, scheme]);
  const column = lane?.columns.at(-1);
  const piece = useQuery({
    queryKey: ["thumbnail", id, rows],
    queryFn: () => fetchPiece(id, null, WIDTH),
    enabled: inViewport && device !== null && !isRunning(recording) && column !== undefined,
    staleTime: Number.POSITIVE_INFINITY,
    retry: false,
  });
  const path = piece.data && column !== undefined ? sparkline(piece.data, column) : "";
  return (
    <div ref={ref} className={classes.thumbnail} title={lane?.title}>
      {path !== "" && (
        <svg viewBox={`0 0 ${WIDTH} ${HEIGHT}`} preserveAspectRatio="none" aria-hidden="true">
          <path
            className="fill-none"
            stroke={lane?.series.at(-1)?.color}
            strokeWidth={1.5}
            vectorEffect="non-scaling-stroke"
            d={path}
          />
        </svg>
      )}
    </div>
  );
}
