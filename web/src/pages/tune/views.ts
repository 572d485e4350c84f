import { Fields as ScoredMoveFields } from "./byHand/Fields";
import { Fields as ChopperFields } from "./chopper/Fields";
import { Results as ChopperResults } from "./chopper/Results";
import { Fields as ClosedLoopFields } from "./closedLoop/Fields";
import { Results as ClosedLoopResults } from "./closedLoop/Results";
import { Fields as CustomSearchFields } from "./customSearch/Fields";
import { Results as CustomSearchResults } from "./customSearch/Results";
import { Fields as FastestMoveFields } from "./fastestMove/Fields";
import { Results as FastestMoveResults } from "./fastestMove/Results";
import { Fields as FirstLookFields } from "./firstLook/Fields";
import { Fields as IdentificationFields } from "./identification/Fields";
import { Results as IdentificationResults } from "./identification/Results";
import type { KindView } from "./kind";
import type { Forms } from "./kinds";
import { Fields as LeastCurrentFields } from "./leastCurrent/Fields";
import { Results as LeastCurrentResults } from "./leastCurrent/Results";
import { Fields as MicrostepFields } from "./microstepCalibration/Fields";
import { Results as MicrostepResults } from "./microstepCalibration/Results";
import { Fields as ResonanceFields } from "./resonanceMap/Fields";
import { Results as ResonanceResults } from "./resonanceMap/Results";
import { Fields as StallGuardFields } from "./stallguard/Fields";
import { Results as StallGuardResults } from "./stallguard/Results";
import { Fields as StealthChopFields } from "./stealthchop/Fields";
import { Results as StealthChopResults } from "./stealthchop/Results";
import type { Kind } from "./study";
import { Fields as TorqueFields } from "./torqueCurve/Fields";
import { Results as TorqueResults } from "./torqueCurve/Results";

/** What each kind of study shows on the page. */
export const VIEWS: { readonly [K in Kind]: KindView<Forms[K]> } = {
  first_look: { Fields: FirstLookFields, Results: null },
  fastest_move: { Fields: FastestMoveFields, Results: FastestMoveResults },
  identification: { Fields: IdentificationFields, Results: IdentificationResults },
  least_current: { Fields: LeastCurrentFields, Results: LeastCurrentResults },
  microstep_calibration: { Fields: MicrostepFields, Results: MicrostepResults },
  resonance_map: { Fields: ResonanceFields, Results: ResonanceResults },
  chopper: { Fields: ChopperFields, Results: ChopperResults },
  stealthchop: { Fields: StealthChopFields, Results: StealthChopResults },
  scored_move: { Fields: ScoredMoveFields, Results: null },
  closed_loop: { Fields: ClosedLoopFields, Results: ClosedLoopResults },
  stallguard: { Fields: StallGuardFields, Results: StallGuardResults },
  custom_search: { Fields: CustomSearchFields, Results: CustomSearchResults },
  torque_curve: { Fields: TorqueFields, Results: TorqueResults },
};
