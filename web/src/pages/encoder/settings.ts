import { type Places, type Rows, type Settings, settingsIn } from "../../lib/rows/settings";
import type { Which } from "./useEncoder";

/** The names of what the page sets, as a module calls them. */
export const LIMIT: Record<Which, string> = {
  internal: "maximum_encoder_deviation",
  external: "external_encoder_maximum_deviation",
};
export const RESOLUTION = "external_encoder_resolution";
export const ACCELERATION = "maximum_acceleration";
export const LIMIT_NAMES = [LIMIT.internal, LIMIT.external, RESOLUTION, ACCELERATION] as const;

const PLACES: Places<{ register: string; acceleration?: true }> = {
  [LIMIT.internal]: [{ register: "ENC_DEVIATION" }],
  [ACCELERATION]: [{ register: "AMAX", acceleration: true }],
};

/** The registers of a chip by those names: an acceleration in pps². */
export function encoderSettings(chip: Rows, clockHz: number): Settings {
  const unit = clockHz ** 2 / 2 ** 41;
  return settingsIn(
    chip,
    PLACES,
    (raw, { acceleration }) => (acceleration ? raw * unit : raw),
    (value, { acceleration }) => (acceleration ? Math.round(value / unit) : value),
  );
}

/** What the index channel of a chip can be told to do, and the bits of ENCMODE that say so. */
export interface IndexUse {
  name: string;
  text: string;
  fields: Record<"clr_cont" | "clr_once" | "clr_enc_x" | "latch_x_act", 0 | 1>;
}

export const INDEX_USES: readonly IndexUse[] = [
  {
    name: "do nothing",
    text: "events are flagged alone",
    fields: { clr_cont: 0, clr_once: 0, clr_enc_x: 0, latch_x_act: 0 },
  },
  {
    name: "zero X_ENC once",
    text: "the next event sets X_ENC to 0",
    fields: { clr_cont: 0, clr_once: 1, clr_enc_x: 1, latch_x_act: 0 },
  },
  {
    name: "latch each time",
    text: "each event keeps X_ENC and XACTUAL in ENC_LATCH and XLATCH",
    fields: { clr_cont: 1, clr_once: 0, clr_enc_x: 0, latch_x_act: 1 },
  },
  {
    name: "zero X_ENC each time",
    text: "each event keeps X_ENC in ENC_LATCH and sets it to 0",
    fields: { clr_cont: 1, clr_once: 0, clr_enc_x: 1, latch_x_act: 0 },
  },
];

/** The use that these bits stand for; null for a mixture of one's own. */
export function indexUse(bits: (field: string) => number | null): IndexUse | null {
  return INDEX_USES.find(({ fields }) => Object.entries(fields).every(([name, bit]) => bits(name) === bit)) ?? null;
}
