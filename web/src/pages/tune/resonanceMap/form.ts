import type { KindForm } from "../kind";

export interface ResonanceForm {
  /** turns of the motor a second */
  velocityMinRps: number;
  velocityMaxRps: number;
  speeds: number;
  /** room from where it stands, to positions above [turns of the motor] */
  travelTurns: number;
  repeats: number;
  /** of the run current, compared with it; null: no other current */
  currentPercent: number | null;
  /** compare the other chopper, too */
  otherChopper: boolean;
}

export const RESONANCE_MAP: KindForm<ResonanceForm> = {
  label: "Quieter",
  text: "How much it vibrates at each speed, which order meets the resonance there, and which setting moves that.",
  title: "Resonance map",
  first: () => ({
    velocityMinRps: 0.2,
    velocityMaxRps: 4,
    speeds: 20,
    travelTurns: 12,
    repeats: 2,
    currentPercent: 70,
    otherChopper: true,
  }),
  wish: (form) => ({
    study: {
      kind: "resonance_map",
      velocity_min_rps: form.velocityMinRps,
      velocity_max_rps: form.velocityMaxRps,
      speeds: form.speeds,
      travel_turns: form.travelTurns,
      repeats: form.repeats,
      current_shares: form.currentPercent === null || form.currentPercent === 100 ? [] : [form.currentPercent / 100],
      other_chopper: form.otherChopper,
    },
    budget: { trials: 30, time_s: 3600, distance_fullsteps: null },
  }),
};
