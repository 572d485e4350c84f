import type { ReactNode } from "react";

/** Lines of a sketch in a box of 72 x 30: what is before is dim, what is wanted has the accent. */
function sketch(before: ReactNode, wanted: ReactNode): ReactNode {
  return (
    <svg viewBox="0 0 72 30" width="72" height="30" aria-hidden="true" focusable="false" fill="none" strokeWidth="2">
      <g stroke="var(--dim)" strokeOpacity="0.6">
        {before}
      </g>
      <g stroke="var(--accent-text)" strokeLinejoin="round" strokeLinecap="round">
        {wanted}
      </g>
    </svg>
  );
}

/** What a goal looks like, by the kind of its study. */
const SKETCHES: Readonly<Record<string, ReactNode>> = {
  first_look: sketch(
    <circle cx="36" cy="15" r="11" />,
    <path d="M27 15a9 9 0 0 1 15.5-6.3M42.5 3.5v5.2h-5.2M45 15a9 9 0 0 1-15.5 6.3M29.5 26.5v-5.2h5.2" />,
  ),
  fastest_move: sketch(<path d="M4 26 20 12H52L68 26" />, <path d="M4 26 12 4H26L34 26" />),
  microstep_calibration: sketch(<path d="M4 26c10 0 12-10 22-10S40 4 68 4" />, <path d="M4 26 68 4" />),
  identification: sketch(
    <path d="M4 15h64" />,
    <path d="M4 4c6 0 6 22 12 22S22 8 28 8s6 12 12 12 6-8 12-8 6 5 16 4" />,
  ),
  resonance_map: sketch(
    <path d="M4 27 68 3M4 27 68 15" />,
    <path d="M4 26h14c8 0 7-20 11-20s3 20 11 20h4c5 0 4-10 7-10s2 10 7 10h10" />,
  ),
  least_current: sketch(<path d="M4 7h64" />, <path d="M4 7h14v9h14v7h36" />),
  custom_search: sketch(
    <path d="M4 8h64M4 15h64M4 22h64" />,
    <path d="M4 22 25 8l21 12 22-9M4 9.5v-3M25 16.5v-3M46 23.5v-3" />,
  ),
  scored_move: sketch(<path d="M4 8h64M4 15h64M4 22h64" />, <path d="M20 4v8M48 11v8M30 18v8" />),
  torque_curve: sketch(<path d="M6 3v23h62" />, <path d="M6 6h24c14 0 20 12 36 15" />),
  chopper: sketch(
    <path d="M4 15l4-9 4 18 4-18 4 18 4-18 4 18 4-9" />,
    <path d="M36 15c4-5 6-5 8 0s5 5 8 0 5-5 8 0 5 4 8 0" />,
  ),
  stealthchop: sketch(<path d="M4 15c6-14 10-14 16 0s10 14 16 0" />, <path d="M36 15V8l4 3 4-7 4 6 4-6 4 6 4-4 8 5" />),
  closed_loop: sketch(<path d="M4 26h8V9h56" />, <path d="M4 26h8c4 0 4-21 10-21s5 6 10 6 5-2 36-2" />),
  stallguard: sketch(
    <path d="M4 26c8 0 8-20 14-20s6 20 14 20" />,
    <>
      <path d="M40 26c8 0 8-20 14-20s6 20 14 20" />
      <path d="M36 3v24" strokeDasharray="3 3" />
    </>,
  ),
};

const OTHER = sketch(<path d="M10 24a26 26 0 0 1 52 0" />, <path d="M36 24 52 9M36 24h.01" />);

export function sketchOf(kind: string): ReactNode {
  return SKETCHES[kind] ?? OTHER;
}
