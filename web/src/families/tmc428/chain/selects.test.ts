import { describe, expect, it } from "vitest";
import { selectNotes } from "./selects";

const PLAIN = { individual: 0, polarity: 0, refmux: 0, board: null, lengths: [12, 12, 12] } as const;

describe("chip selects", () => {
  it("say nothing of a plain chain, or before they are known", () => {
    expect(selectNotes(PLAIN)).toEqual([]);
    expect(selectNotes({ ...PLAIN, individual: null, board: "individual" })).toEqual([]);
  });

  it("ask for low polarity and three drivers where they are individual", () => {
    const notes = selectNotes({ ...PLAIN, individual: 1, polarity: 1, refmux: 1, lengths: [12, 12, 12, 12] }).join(" ");
    for (const word of ["polarity_nscs_s to 0", "4 drivers", "74HC157", "larger packages"])
      expect(notes).toContain(word);
  });

  it("tell of a board that is wired otherwise", () => {
    expect(selectNotes({ ...PLAIN, board: "individual" })[0]).toContain("only driver 1");
    expect(selectNotes({ ...PLAIN, individual: 1, board: "common" }).at(-1)).toContain("no driver");
    expect(selectNotes({ ...PLAIN, individual: 1, board: "individual" })).toHaveLength(1);
  });
});
