import type { Places } from "./EmulatorParts";
import type { EmulatorState } from "./useEmulator";

export interface EmulatedSwitch {
  active: boolean;
  /** null while it follows the stage */
  forced: boolean | null;
}

/** Where the switches of a stage stand [full steps]. The home switch has two edges, where there is one. */
export interface StagePlaces {
  left: number;
  right: number;
  homeFrom: number | null;
  homeTo: number | null;
}

/** One axis of an emulated device, whatever its model: its stage, and where the carriage really is. */
export interface EmulatedAxis {
  axis: number;
  positionFullsteps: number;
  chipTimeS: number;
  places: StagePlaces;
  switches: Record<"left" | "right", EmulatedSwitch> & { home: EmulatedSwitch | null };
}

/** A motor's own stage, as modules and the chips with a motor have it. */
function motorStage(axis: number, chipTimeS: number, stage: Places, switches: EmulatedAxis["switches"]): EmulatedAxis {
  const home = switches.home !== null;
  return {
    axis,
    positionFullsteps: stage.position_fullsteps,
    chipTimeS,
    places: {
      left: stage.left_at_fullsteps,
      right: stage.right_at_fullsteps,
      homeFrom: home ? stage.home_from_fullsteps : null,
      homeTo: home ? stage.home_to_fullsteps : null,
    },
    switches,
  };
}

export function emulatedAxis(state: EmulatorState | undefined, axis: number): EmulatedAxis | undefined {
  if (state === undefined) return undefined;
  if ("stage" in state)
    return axis === 0 ? motorStage(axis, state.chip_time_s, state.stage, state.switches) : undefined;
  if (!("axes" in state)) return undefined; // a plain one has no stage
  const found = state.axes.find((candidate) => candidate.axis === axis);
  if (found === undefined) return undefined;
  if ("motor" in found) return motorStage(axis, state.chip_time_s, found.stage, { ...found.switches, home: null });
  const { stage, switches } = found;
  return {
    axis,
    positionFullsteps: found.position_fullsteps,
    chipTimeS: state.chip_time_s,
    places: {
      left: stage.left_at_fullsteps,
      right: stage.right_at_fullsteps,
      homeFrom: stage.ref_from_fullsteps,
      homeTo: stage.ref_to_fullsteps,
    },
    switches: { left: switches.left, right: switches.right, home: switches.reference },
  };
}
