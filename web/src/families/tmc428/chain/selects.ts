export interface Selects {
  /** csCommonIndividual */
  individual: number | null;
  /** polarity_nscs_s */
  polarity: number | null;
  refmux: number | null;
  /** how an emulated board is wired; null for real ones, of which nobody tells */
  board: "common" | "individual" | null;
  /** bits of each driver in the design */
  lengths: readonly number[];
}

/** What is to be known of the chip selects as they are planned (DS-TMC428 9.7). */
export function selectNotes({ individual, polarity, refmux, board, lengths }: Selects): string[] {
  if (individual === null) return [];
  const notes: string[] = [];
  if (individual === 1) {
    if (polarity === 1) notes.push("Three individual selects are low active always: set polarity_nscs_s to 0.");
    if (lengths.length > 3) notes.push(`There are three selects, and ${lengths.length} drivers in the design.`);
    if (refmux === 1)
      notes.push("Multiplexed switches need nSCS_S at the 74HC157; it then follows the bits of driver 1 alone.");
    notes.push("Only the larger packages have nSCS2 and nSCS3.");
  }
  if (board !== null && (board === "individual") !== (individual === 1))
    notes.push(
      board === "individual"
        ? "The emulated board has a select for each driver: with one common select only driver 1 is reached."
        : "The emulated board has one select for its chain: with individual selects no driver gets its bits.",
    );
  return notes;
}
