/** What tells of lost steps: an encoder, or a switch away from which moves go. */
export type SeenBy = "encoder" | "left switch" | "right switch";
export const SEEN_BY: SeenBy[] = ["encoder", "left switch", "right switch"];

/** What a form begins with. `sees`: an encoder can tell of lost steps */
export const firstSeenBy = (sees: boolean): SeenBy => (sees ? "encoder" : "left switch");
