import { type EmulatorState, isModuleState, isTmc4361State } from "./useEmulator";

export interface EmulatedSwitch {
  active: boolean;
  /** null while it follows the stage */
  forced: boolean | null;
}

/** Where the switches of a stage stand [full steps]. The home switch has two edges. */
export interface StagePlaces {
  left: number;
  right: number;
  homeFrom: number;
  homeTo: number;
}

/** One axis of an emulated device, whatever its model: its stage, and where the carriage really is. */
export interface EmulatedAxis {
  axis: number;
  positionFullsteps: number;
  chipTimeS: number;
  places: StagePlaces;
  switches: Record<"left" | "right" | "home", EmulatedSwitch>;
}

export function emulatedAxis(state: EmulatorState | undefined, axis: number): EmulatedAxis | undefined {
  if (state === undefined) return undefined;
  if (isModuleState(state) || isTmc4361State(state)) {
    const { stage, switches } = state;
    return axis !== 0
      ? undefined
      : {
          axis,
          positionFullsteps: stage.position_fullsteps,
          chipTimeS: state.chip_time_s,
          places: {
            left: stage.left_at_fullsteps,
            right: stage.right_at_fullsteps,
            homeFrom: stage.home_from_fullsteps,
            homeTo: stage.home_to_fullsteps,
          },
          switches,
        };
  }
  const found = state.axes.find((candidate) => candidate.axis === axis);
  if (found === undefined) return undefined;
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
