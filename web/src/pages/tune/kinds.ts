import { SCORED_MOVE, type ScoredMoveForm } from "./byHand/form";
import { CHOPPER, type ChopperForm } from "./chopper/form";
import { CLOSED_LOOP, type ClosedLoopForm } from "./closedLoop/form";
import { FASTEST_MOVE, type FastestMoveForm } from "./fastestMove/form";
import { FIRST_LOOK, type FirstLookForm } from "./firstLook/form";
import { IDENTIFICATION, type IdentificationForm } from "./identification/form";
import type { KindForm } from "./kind";
import { LEAST_CURRENT, type LeastCurrentForm } from "./leastCurrent/form";
import { MICROSTEP_CALIBRATION, type MicrostepForm } from "./microstepCalibration/form";
import { RESONANCE_MAP, type ResonanceForm } from "./resonanceMap/form";
import { STALLGUARD, type StallGuardForm } from "./stallguard/form";
import { STEALTHCHOP, type StealthChopForm } from "./stealthchop/form";
import type { Kind, Wish } from "./study";
import { TORQUE_CURVE, type TorqueForm } from "./torqueCurve/form";

/** The form of each kind: what was typed stays when another one is looked at. */
export interface Forms {
  first_look: FirstLookForm;
  fastest_move: FastestMoveForm;
  identification: IdentificationForm;
  least_current: LeastCurrentForm;
  microstep_calibration: MicrostepForm;
  resonance_map: ResonanceForm;
  scored_move: ScoredMoveForm;
  stallguard: StallGuardForm;
  torque_curve: TorqueForm;
  closed_loop: ClosedLoopForm;
  chopper: ChopperForm;
  stealthchop: StealthChopForm;
}

/** The studies, in the order of the choice. */
export const KINDS: { readonly [K in Kind]: KindForm<Forms[K]> } = {
  first_look: FIRST_LOOK,
  fastest_move: FASTEST_MOVE,
  identification: IDENTIFICATION,
  least_current: LEAST_CURRENT,
  microstep_calibration: MICROSTEP_CALIBRATION,
  resonance_map: RESONANCE_MAP,
  stallguard: STALLGUARD,
  torque_curve: TORQUE_CURVE,
  closed_loop: CLOSED_LOOP,
  chopper: CHOPPER,
  stealthchop: STEALTHCHOP,
  scored_move: SCORED_MOVE,
};

/** The kinds; the one of which nothing has to be known comes first. */
export const NAMES = Object.keys(KINDS) as [Kind, ...Kind[]];

export const WISHES = NAMES.map((value) => ({ value, label: KINDS[value].label }));

/** What all forms begin with. */
export function firstForms(microstepsPerTurn: number | null): Forms {
  return {
    first_look: FIRST_LOOK.first(microstepsPerTurn),
    fastest_move: FASTEST_MOVE.first(microstepsPerTurn),
    identification: IDENTIFICATION.first(microstepsPerTurn),
    least_current: LEAST_CURRENT.first(microstepsPerTurn),
    microstep_calibration: MICROSTEP_CALIBRATION.first(microstepsPerTurn),
    resonance_map: RESONANCE_MAP.first(microstepsPerTurn),
    stallguard: STALLGUARD.first(microstepsPerTurn),
    torque_curve: TORQUE_CURVE.first(microstepsPerTurn),
    closed_loop: CLOSED_LOOP.first(microstepsPerTurn),
    chopper: CHOPPER.first(microstepsPerTurn),
    stealthchop: STEALTHCHOP.first(microstepsPerTurn),
    scored_move: SCORED_MOVE.first(microstepsPerTurn),
  };
}

/** The document of a study as the server wants it. */
export function documentOf<K extends Kind>(kind: K, forms: Forms, device: string, axis: number): Wish {
  return { device, axis, ...KINDS[kind].wish(forms[kind]) };
}

/** Its name, or what it is. */
export function titleOf({ name, study: { kind } }: { name: string; study: { kind: Kind } }): string {
  return name || KINDS[kind].title;
}
