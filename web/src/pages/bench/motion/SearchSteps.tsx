import { Box } from "@mantine/core";

/** One part of a search: which way, how fast, until what. */
export interface SearchStep {
  to: "left" | "right" | "zero";
  fast: boolean;
  until: string;
}

const ARROWS = { left: "←", right: "→", zero: "0" } as const;

/** What a search is going to do, in order. */
export function SearchSteps({ steps }: { steps: readonly SearchStep[] }) {
  return (
    <Box component="ol" mih={80} className="indent hint m-0 tight" aria-label="What the search does">
      {steps.map(({ to, fast, until }, index) => (
        <li key={`${to}${until}`} value={index + 1}>
          <span className="mono ink" aria-hidden>
            {ARROWS[to]}
          </span>{" "}
          {fast ? "fast" : "slowly"} until {until}
        </li>
      ))}
    </Box>
  );
}
