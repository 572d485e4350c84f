import type { KindForm } from "../kind";

export interface IdentificationForm {
  /** [turns of the motor a second] */
  velocityRps: number;
  hops: number;
  /** with the run current [N m]; null: unknown */
  holdTorqueNm: number | null;
}

export const IDENTIFICATION: KindForm<IdentificationForm> = {
  label: "Know motor and machine",
  text: "Resonance, damping, friction, inertia, backlash and lines of the encoder, each with its interval: by the encoder. The setting stays.",
  title: "Motor and machine",
  first: () => ({ velocityRps: 0.1, hops: 24, holdTorqueNm: null }),
  wish: ({ velocityRps, hops, holdTorqueNm }) => ({
    study: { kind: "identification", velocity_rps: velocityRps, hops, hold_torque_nm: holdTorqueNm },
  }),
};
