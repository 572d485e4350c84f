import { describe, expect, it } from "vitest";
import { foldedRows, leastHeight, TIME_AXIS_PX } from "./folding";
import type { ScopeRow, ScopeTrace } from "./model";
import { ROWS } from "./rows";

const ROWS_OF_A_CHIP: ScopeRow[] = ROWS.map((row) => ({
  row,
  unit: "",
  traces: row.channels.map(
    (channel) => ({ ...channel, shown: true, measured: channel.measured }) as unknown as ScopeTrace,
  ),
}));

function heightOf(rows: readonly ScopeRow[]): number {
  return rows.reduce((sum, row) => sum + leastHeight(row, false) + 2, TIME_AXIS_PX);
}

describe("plots of a scope that is too low", () => {
  it("are all open where there is room", () => {
    expect(foldedRows(ROWS_OF_A_CHIP, heightOf(ROWS_OF_A_CHIP), {}, false).size).toBe(0);
  });

  it("fold one after the other, and what is left fits with the whole of its legend", () => {
    let before = 0;
    for (let height = heightOf(ROWS_OF_A_CHIP); height > 400; height -= 10) {
      const folded = foldedRows(ROWS_OF_A_CHIP, height, {}, false);
      expect(folded.size).toBeGreaterThanOrEqual(before);
      before = folded.size;
      const open = ROWS_OF_A_CHIP.filter(({ row }) => !folded.has(row.id));
      expect(heightOf(open)).toBeLessThanOrEqual(height);
      expect(open.map(({ row }) => row.id)).toContain("position");
    }
    expect(before).toBeGreaterThan(4);
  });

  it("leave one open however low, and do as the reader says", () => {
    expect(foldedRows(ROWS_OF_A_CHIP, 10, {}, false).size).toBe(ROWS_OF_A_CHIP.length - 1);
    expect(foldedRows(ROWS_OF_A_CHIP, 10, { coils: false }, false).has("coils")).toBe(false);
    expect([...foldedRows(ROWS_OF_A_CHIP, 9999, { position: true }, false)]).toEqual(["position"]);
  });

  it("need more room with the differences between the cursors", () => {
    const [position] = ROWS_OF_A_CHIP as [ScopeRow];
    expect(leastHeight(position, true)).toBeGreaterThan(leastHeight(position, false));
  });
});
