import { Box } from "@mantine/core";
import { compact, fixed } from "../format";
import type { LinkInfo } from "./useLinkInfo";

/** Calls a second: what the wire could carry, and how much of it is used. Without a limit only what is used. */
export function WireBar({ link, old = false }: { link: LinkInfo; old?: boolean }) {
  const possible = link.calls_per_s_possible;
  const share = link.share ?? (possible ? link.calls_per_s / possible : null);
  const percent = share === null ? 0 : Math.min(100, 100 * share);
  return (
    <span className={`fades inline wrap gap-8`} data-old={old}>
      {possible !== null && (
        // the numbers beside it say the same
        <Box component="span" w={120} className="meter rigid" aria-hidden>
          <span style={{ width: `${percent}%` }} />
        </Box>
      )}
      <span className="nowrap">
        <b className="num">{fixed(link.calls_per_s)}</b>
        {possible === null ? (
          " calls/s, no limit of the wire"
        ) : (
          <>
            {" of "}
            <span className="num">{fixed(possible)}</span> calls/s
            <span className="dim">
              {" · "}
              <span className="num">{compact(percent, 3)}</span> %
            </span>
          </>
        )}
      </span>
    </span>
  );
}
