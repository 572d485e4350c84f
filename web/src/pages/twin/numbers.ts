import { compact, fixed } from "../../lib/format";
import type { Quantity } from "../../lib/palette";
import type { TwinLook, TwinState } from "./useTwin";

export interface NumberRow {
  name: string;
  value: string;
  /** where it comes from, or why there is none */
  note: string;
  quantity: Quantity | null;
  known: boolean;
}

const FIELD_FROM = {
  mscnt: "the microstep counter",
  currents: "the coil currents",
  position: "the position counter: meant, not measured",
} as const;
const LOAD_FROM = { load_angle: "told by the chip", deviation: "encoder less position" } as const;

/** What the picture shows, in words and numbers: for those who do not see it, and to read off. */
export function numbersOf(state: TwinState): NumberRow[] {
  const look = state.look;
  const channels = new Set(state.channels);
  const unit = state.place_unit === "mm" ? " mm" : "°";
  const place = state.place_unit === "mm" ? "carriage" : "table";

  function missing(...wanted: string[]): string {
    if (wanted.some((channel) => channels.has(channel))) return "not known now";
    return "this device does not tell it";
  }
  function row(
    name: string,
    value: number | null | undefined,
    text: (value: number) => string,
    note: string,
    quantity: Quantity | null,
    ...wanted: string[]
  ): NumberRow {
    const known = value !== null && value !== undefined;
    return { name, value: known ? text(value) : "–", note: known ? note : missing(...wanted), quantity, known };
  }
  const degrees = (value: number) => `${fixed(value, 1)}°`;
  const at = (value: number) => `${fixed(value, state.place_unit === "mm" ? 3 : 2)}${unit}`;
  const share = (value: number) => fixed(100 * value, 0, "%");

  return [
    row(`${place}, by the counter`, look?.place_commanded, at, "position counter", "position", "position"),
    row(`${place}, by the encoder`, look?.place_measured, at, "encoder", "encoder_position", "encoder_position"),
    row("shaft, by the counter", turnOf(look?.commanded_deg), degrees, "in its turn", "position", "position"),
    row(
      "shaft, by the encoder",
      turnOf(look?.measured_deg),
      degrees,
      "in its turn",
      "encoder_position",
      "encoder_position",
    ),
    row("speed", look?.velocity_pps, (pps) => compact(pps, 5, "pps"), "ramp generator", "velocity", "velocity"),
    row("field", look?.field_deg, degrees, look?.field_from ? FIELD_FROM[look.field_from] : "", null, "position"),
    row(
      "load angle",
      look?.load_deg,
      degrees,
      look?.load_from ? LOAD_FROM[look.load_from] : "",
      "load_angle",
      "load_angle",
      "deviation",
    ),
    row("current of coil A", look?.current_a, share, "of full current", "current_a", "current_a"),
    row("current of coil B", look?.current_b, share, "of full current", "coil_b", "current_b"),
    ...switches(look, channels),
    lost(look, channels),
  ];
}

/** What to say when the motor turns faster than a picture can follow, else null. */
export function stroboscope(state: TwinState): string | null {
  const look = state.look;
  if (!look || look.velocity_pps === null || look.commanded_deg === null || !look.position) return null;
  const turnsPerS = Math.abs((look.velocity_pps * look.commanded_deg) / look.position / 360);
  if (!Number.isFinite(turnsPerS) || turnsPerS < state.updates_per_s_max / 4) return null;
  return `${compact(turnsPerS, 3)} turns a second: more than ${state.updates_per_s_max} pictures a second can follow, so what seems to turn may not do so this way.`;
}

function turnOf(degrees: number | null | undefined): number | null {
  return degrees === null || degrees === undefined ? null : ((degrees % 360) + 360) % 360;
}

function switches(look: TwinLook | null, channels: Set<string>): NumberRow[] {
  const rows: readonly (readonly [string, boolean | null | undefined, Quantity, readonly string[]])[] = [
    ["left switch", look?.switch_left, "switch_left", ["switch_left"]],
    ["right switch", look?.switch_right, "switch_right", ["switch_right"]],
    ["home switch", look?.switch_home, "switch_home", ["switch_home", "switch_reference"]],
  ];
  return rows.map(([name, closed, quantity, wanted]) => {
    const known = closed !== null && closed !== undefined;
    const why = wanted.some((channel) => channels.has(channel)) ? "not known now" : "this device does not tell it";
    return { name, value: known ? (closed ? "active" : "open") : "–", note: known ? "" : why, quantity, known };
  });
}

function lost(look: TwinLook | null, channels: Set<string>): NumberRow {
  const slips = look?.slips ?? null;
  const why = channels.has("deviation") ? "not known now" : "without an encoder they are not seen";
  return {
    name: "lost steps",
    value: slips ? `${fixed(Math.abs(slips.lost_full_steps))} full steps` : "–",
    note: slips ? (slips.events === 0 ? "no slip seen" : `${slips.events} slips seen`) : why,
    quantity: null,
    known: slips !== null,
  };
}
