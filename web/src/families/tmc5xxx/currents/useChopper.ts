import { api, type Schemas } from "../../../api/client";
import { useCalc } from "../../../lib/useCalc";
import { useLocalKept } from "../../../lib/useKept";
import type { Registers } from "./chip";
import type { Model } from "./models";
import type { SpeedScale } from "./speed";

export interface Motor {
  ohm: number;
  mH: number;
  supplyV: number;
  holdingNm: number;
  ratedA: number;
  chopperKhz: number;
}

/** A common 40 mm motor, as on the ramp pages. */
const MOTOR: Motor = { ohm: 2.3, mH: 4.4, supplyV: 24, holdingNm: 0.45, ratedA: 1.5, chopperKhz: 25 };

/** What the chopper's calculator is asked about the motor, and what it answers. */
export function useChopper(chip: Registers, model: Model, scale: SpeedScale, runRmsA: number | null) {
  const [motor, setAll] = useLocalKept<Motor>("stepscope.currents.motor", MOTOR);
  const irun = chip.planned("IHOLD_IRUN", "IRUN");
  const body: Schemas["Chopper"] | null =
    runRmsA === null || irun === null
      ? null
      : {
          model,
          clock_hz: scale.clockHz,
          resistance_ohm: motor.ohm,
          inductance_h: motor.mH / 1000,
          current_a: runRmsA,
          supply_v: motor.supplyV,
          holding_torque_nm: motor.holdingNm,
          rated_current_a: motor.ratedA,
          full_steps_per_rev: scale.fullStepsPerTurn,
          microsteps_per_full_step: scale.microsteps as NonNullable<Schemas["Chopper"]["microsteps_per_full_step"]>,
          irun,
          chopper_hz: motor.chopperKhz * 1000,
        };
  const answer = useCalc<Schemas["Chopper"], Schemas["ChopperResult"]>("chopper", body, (asked, signal) =>
    api.POST("/api/v1/calc/chopper", { body: asked, signal }),
  );
  return { motor, setMotor: (part: Partial<Motor>) => setAll({ ...motor, ...part }), runRmsA, answer };
}

export type ChopperQuestion = ReturnType<typeof useChopper>;
