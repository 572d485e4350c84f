import type { KindForm } from "../kind";

export interface FastestMoveForm {
  /** of a move [microsteps] */
  distance: number;
  marginPercent: number;
  trials: number;
  quiet: boolean;
  velocityMaxPps: number | null;
  accelerationMaxPps2: number | null;
  /** try on an emulated twin first, with this motor */
  twin: boolean;
  holdingTorqueNm: number;
  ratedCurrentA: number;
  loadInertiaKgm2: number;
}

export const FASTEST_MOVE: KindForm<FastestMoveForm> = {
  label: "Faster",
  text: "The shortest move by a distance at which no step is lost, with a margin.",
  title: "Fastest move",
  first: (microstepsPerTurn) => ({
    distance: 2 * (microstepsPerTurn ?? 51_200),
    marginPercent: 10,
    trials: 30,
    quiet: false,
    velocityMaxPps: null,
    accelerationMaxPps2: null,
    twin: true,
    holdingTorqueNm: 0.45,
    ratedCurrentA: 1.5,
    loadInertiaKgm2: 0,
  }),
  wish: (form) => ({
    budget: { trials: form.trials },
    study: {
      kind: "fastest_move",
      distance: Math.round(form.distance),
      margin: form.marginPercent / 100,
      quiet: form.quiet,
      velocity_max_pps: form.velocityMaxPps,
      acceleration_max_pps2: form.accelerationMaxPps2,
      twin: form.twin
        ? {
            motor: {
              holding_torque_nm: form.holdingTorqueNm,
              rated_current_a: form.ratedCurrentA,
              load_inertia_kgm2: form.loadInertiaKgm2,
            },
          }
        : null,
    },
  }),
};
