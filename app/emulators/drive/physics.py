"""The motor's side of the cells: constants in, plant state out. For every chip that turns this motor."""

from __future__ import annotations

import math

from . import kernel as k
from .options import DriveOptions, EncoderErrors, MotorOptions
from .plant import PlantState

SUPPLY_LAG_S = 1e-3
"""How fast the voltage at the driver follows: its capacitors times the resistance, as 1000 uF behind 1 ohm (INFERRED)
[s]."""

_BRIDGES = {
    k.REGULATED: "regulated",
    k.CLASSIC: "regulated",
    k.IN_FULL_STEPS: "regulated",
    k.OPEN: "open",
    k.SHORTED: "shorted",
    k.VOLTAGE: "voltage",
}


def set_physics(options: DriveOptions, s: k.Cells, f: k.Floats, tick_clocks: int) -> None:
    """What `kernel.turn` and `kernel.stall_guard` need of motor, load and driver, for ticks of `tick_clocks`."""
    motor = options.motor
    s[k.SUBSTEPS] = options.steps_in(tick_clocks)
    dt = tick_clocks / options.clock_hz / int(s[k.SUBSTEPS])
    f[k.DT], f[k.DT_J] = dt, dt / options.rotor_side_kgm2
    f[k.DAMP] = 1 / (1 + motor.viscous_nms * dt / options.rotor_side_kgm2)
    _set_coupling(options, s, f)
    f[k.SUPPLY_OHM] = options.supply_resistance_ohm
    s[k.APART] = s[k.COUPLED] or options.supply_resistance_ohm > 0
    f[k.SUPPLY_LAG] = -math.expm1(-tick_clocks / options.clock_hz / SUPPLY_LAG_S)
    f[k.TEETH], f[k.KT], f[k.TD] = motor.rotor_teeth, motor.torque_constant, motor.detent_torque_nm
    _set_flux(motor, s, f)
    f[k.KEEP] = math.exp(-motor.resistance_ohm * dt / motor.inductance_h)
    f[k.GAIN] = (1 - f[k.KEEP]) / motor.resistance_ohm
    f[k.ALPHA] = -math.expm1(-dt / options.regulator_s)
    f[k.FULL_SCALE] = options.full_scale_a
    told = motor.load_value
    f[k.S0], f[k.V_HALF] = told.full_scale, told.half_speed_fullsteps_per_s
    f[k.NOISE], f[k.NOISE_V], f[k.POLES] = told.noise, told.noise_with_speed / 1000.0, told.pole_tolerance
    left, right, step = (
        options.stage.left_end_fullsteps,
        options.stage.right_end_fullsteps,
        math.pi / 2 / motor.rotor_teeth,
    )
    if left is not None or right is not None:
        f[k.LOW_END] = -math.inf if left is None else left * step
        f[k.HIGH_END] = math.inf if right is None else right * step


def _set_coupling(options: DriveOptions, s: k.Cells, f: k.Floats) -> None:
    coupling = options.load.coupling
    s[k.COUPLED] = coupling is not None and not options.rigid
    if coupling is not None:
        f[k.LOAD_DT_J] = f[k.DT] / options.load.inertia_kgm2
        f[k.SPRING], f[k.SPRING_DAMPING] = coupling.stiffness_nm_rad, coupling.damping_nms
        f[k.SPRING_PLAY] = coupling.backlash_fullsteps * math.pi / 4 / options.motor.rotor_teeth


def set_graduation(errors: EncoderErrors, lines: int, s: k.Cells, f: k.Floats) -> None:
    """What `kernel.external_counts` needs of an encoder with so many lines whose graduation is off."""
    f[k.EX1], f[k.PX1] = math.radians(errors.eccentricity_deg), math.radians(errors.eccentricity_phase_deg)
    f[k.EX2], f[k.PX2] = math.radians(errors.second_harmonic_deg), math.radians(errors.second_harmonic_phase_deg)
    f[k.EXS], f[k.PXS] = errors.line_error * 2 * math.pi / lines, math.radians(errors.line_error_phase_deg)
    f[k.LINES], f[k.PLAY] = lines, math.radians(errors.backlash_deg)
    s[k.UNTRUE] = bool(f[k.EX1] or f[k.EX2] or f[k.EXS] or f[k.PLAY])


def _set_flux(motor: MotorOptions, s: k.Cells, f: k.Floats) -> None:
    """Flux of both coils: A's is cos(e) + h cos(3e), B's sin(e + q) - h sin(3e), each with its share of the torque."""
    kt_a = motor.torque_constant * (1 + motor.phase_unbalance / 2)
    kt_b = motor.torque_constant * (1 - motor.phase_unbalance / 2)
    if motor.open_phase != "none":  # without current a coil makes no torque
        kt_a, kt_b = (0.0, kt_b) if motor.open_phase == "a" else (kt_a, 0.0)
    apart, third = math.radians(motor.quadrature_error_deg), math.radians(motor.fourth_harmonic_deg)
    f[k.FLUX_A], f[k.FLUX_A3] = kt_a * (1 + third), 4 * kt_a * third
    f[k.FLUX_B], f[k.FLUX_B3] = kt_b * (math.cos(apart) - 3 * third), 4 * kt_b * third
    f[k.FLUX_BX] = kt_b * math.sin(apart)
    s[k.UNEVEN] = bool(motor.phase_unbalance or apart or third or motor.open_phase != "none")


def plant_state_of(s: k.Cells, f: k.Floats, motor: MotorOptions) -> PlantState:
    """State of motor and shaft at the last tick. The field is what LOOK says."""
    angle = float(f[k.TEETH] * f[k.THETA])
    field = (int(s[k.LOOK]) + 0.5) * math.pi / 512
    ia, ib, ia0, ib0 = (float(f[cell]) for cell in (k.IA, k.IB, k.IA0, k.IB0))
    rise = motor.inductance_h / float(f[k.DT])
    return PlantState(
        rotor_rad=float(f[k.THETA]),
        rotor_fullsteps=angle / (math.pi / 2),
        load_fullsteps=(float(f[k.TEETH] * f[k.LOAD_THETA]) if s[k.COUPLED] else angle) / (math.pi / 2),
        speed_rad_s=float(f[k.OMEGA]),
        current_a_a=ia,
        current_b_a=ib,
        voltage_a_v=motor.resistance_ohm * (ia + ia0) / 2 + rise * (ia - ia0) + float(f[k.EMF_A]),
        voltage_b_v=motor.resistance_ohm * (ib + ib0) / 2 + rise * (ib - ib0) + float(f[k.EMF_B]),
        torque_nm=float(f[k.TORQUE]),
        field_fullsteps=field / (math.pi / 2),
        load_angle_deg=math.degrees(math.remainder(field - angle, 2 * math.pi)),
        lost_fullsteps=4 * round((field - angle) / (2 * math.pi)),
        current_scale=int(s[k.CS]),
        bridges=_BRIDGES[int(s[k.BRIDGES])],
        supply_v=float(f[k.SUPPLY]),
    )
