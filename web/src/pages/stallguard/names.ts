/** Axis parameters of this page, by the names of the module's table. */
export const AP = {
  stopOnStall: "stop_on_stall",
  stallThreshold: "stallguard2_threshold",
  stallFilter: "stallguard2_filter_enable",
  coolOn: "smartenergy_threshold_speed",
  coolOff: "speed_threshold_coolstep_fullstep",
  coolStart: "smartenergy_hysteresis_start",
  coolWidth: "smartenergy_hysteresis",
  coolUp: "smartenergy_current_up_step",
  coolDown: "smartenergy_current_down_step",
  coolMinimum: "smartenergy_current_minimum",
  stealthBelow: "pwm_threshold_speed",
  stealthGradient: "pwm_gradient",
  runCurrent: "maximum_current",
  scaler: "global_current_scaler",
  unitMode: "unit_mode",
  acceleration: "maximum_acceleration",
} as const;

export const NAMES = Object.values(AP);
