import { SCORED_MOVE } from "./byHand/form";
import { CHOPPER } from "./chopper/form";
import { CLOSED_LOOP } from "./closedLoop/form";
import { CUSTOM_SEARCH } from "./customSearch/form";
import { FASTEST_MOVE } from "./fastestMove/form";
import { FIRST_LOOK } from "./firstLook/form";
import { IDENTIFICATION } from "./identification/form";
import type { KindForm } from "./kind";
import { LEAST_CURRENT } from "./leastCurrent/form";
import { MICROSTEP_CALIBRATION } from "./microstepCalibration/form";
import { RESONANCE_MAP } from "./resonanceMap/form";
import { STALLGUARD } from "./stallguard/form";
import { STEALTHCHOP } from "./stealthchop/form";
import type { Kind, Wish } from "./study";
import { TORQUE_CURVE } from "./torqueCurve/form";

/** The studies, in the order of the choice. */
const OF_KINDS = {
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
  custom_search: CUSTOM_SEARCH,
};
/** The form of each kind: what was typed stays when another one is looked at. */
export type Forms = { [K in Kind]: ReturnType<(typeof OF_KINDS)[K]["first"]> };
export const KINDS: { readonly [K in Kind]: KindForm<Forms[K]> } = OF_KINDS;

/** The kinds; the one of which nothing has to be known comes first. */
export const NAMES = Object.keys(KINDS) as [Kind, ...Kind[]];

const BLIND: readonly Kind[] = ["first_look", "fastest_move", "torque_curve"];

/** The goals of an axis, each with what it is called. `sees`: its chip reads an encoder, which most of them need */
export function goalsOf(sees: boolean) {
  return (sees ? NAMES : BLIND).map((value) => ({ value, label: KINDS[value].label }));
}

/** What all forms begin with. */
export function firstForms(microstepsPerTurn: number | null, sees = true): Forms {
  const forms = NAMES.map((kind) => [kind, KINDS[kind].first(microstepsPerTurn, sees)]);
  return Object.fromEntries(forms) as Forms;
}

/** The document of a study as the server wants it. */
export function documentOf<K extends Kind>(kind: K, forms: Forms, device: string, axis: number): Wish {
  return { device, axis, ...KINDS[kind].wish(forms[kind]) };
}

/** Its name, or what it is. */
export function titleOf({ name, study: { kind } }: { name: string; study: { kind: Kind } }): string {
  return name || KINDS[kind].title;
}
