"""The torque that a two-phase stepper motor can give at a speed, and what a motion asks of it.

Up to some speed the driver holds its current, and torque is Kt * I. Beyond, the supply cannot drive that current
against the coils' inductance and the back-EMF; the most that a rotor can then take is the pull-out torque of a
synchronous machine on a fixed voltage. Detent torque, resonances and the chopper's lag are left out: a margin is there
for them.

Conventions as in the emulated drive: `current_a` is the peak of the sine, Kt = holding torque / (sqrt(2) * rated
current), because holding torque is given with both phases at the rated current.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

# Points of a torque curve over which the fastest moves are summed up: their times are then good to 1e-4 relative.
_GRID = 600


@dataclass(frozen=True)
class StepperMotor:
    """A motor with its driver and what hangs on it. All above 0, but the last three, which may be 0.

    full_steps_per_rev, microsteps_per_full_step : of the axis; 4 full steps are an electrical turn
    inertia_kgm2 : of rotor and load together, at the motor's shaft
    friction_nm : against any motion; damping_nms : growing with speed [N m s/rad]; load_nm : against the motion, too

    Raises ValueError outside of that.
    """

    holding_torque_nm: float = 0.45
    rated_current_a: float = 1.5
    current_a: float = 1.5
    resistance_ohm: float = 2.3
    inductance_h: float = 4.4e-3
    supply_v: float = 24.0
    inertia_kgm2: float = 2e-4
    full_steps_per_rev: float = 200.0
    microsteps_per_full_step: float = 256.0
    friction_nm: float = 0.005
    damping_nms: float = 1e-3
    load_nm: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            free = field.name in ("friction_nm", "damping_nms", "load_nm")
            if not math.isfinite(value) or value < 0 or (value == 0 and not free):
                raise ValueError(f"{field.name} is {'not below' if free else 'above'} 0 and finite, got {value}")

    @property
    def torque_constant(self) -> float:
        """[N m/A], also the back-EMF's [V s/rad]: both of the peaks."""
        return self.holding_torque_nm / (math.sqrt(2) * self.rated_current_a)

    @property
    def microstep_rad(self) -> float:
        """The angle of one microstep [rad]."""
        return 2 * math.pi / (self.full_steps_per_rev * self.microsteps_per_full_step)

    def available_nm(self, velocity_pps: ArrayLike) -> FloatArray:
        """The most torque at a speed [N m, not negative], in the shape of `velocity_pps` [microsteps/s, any sign]."""
        speed = np.abs(np.asarray(velocity_pps, dtype=np.float64)) * self.microstep_rad
        kt, electrical = self.torque_constant, self.full_steps_per_rev / 4
        impedance = np.hypot(self.resistance_ohm, electrical * speed * self.inductance_h)
        pull_out = kt * self.supply_v / impedance - kt**2 * speed * self.resistance_ohm / impedance**2
        return np.asarray(np.clip(pull_out, 0.0, kt * self.current_a))

    def resisting_nm(self, velocity_pps: ArrayLike) -> FloatArray:
        """What friction, damping and load take at a speed [N m, not negative]; at rest what it takes to leave."""
        speed = np.abs(np.asarray(velocity_pps, dtype=np.float64)) * self.microstep_rad
        return np.asarray(self.friction_nm + self.load_nm + self.damping_nms * speed)

    def required_nm(self, velocity_pps: ArrayLike, acceleration_pps2: ArrayLike) -> FloatArray:
        """What a motion asks of the motor [N m, signed]: inertia, and what resists it, which helps in braking."""
        velocity, acceleration = np.asarray(velocity_pps), np.asarray(acceleration_pps2)
        way = np.where(velocity != 0, np.sign(velocity), np.sign(acceleration))
        inertia = self.inertia_kgm2 * self.microstep_rad * acceleration
        return np.asarray(inertia + way * self.resisting_nm(velocity), dtype=np.float64)

    def margin(self, velocity_pps: ArrayLike, acceleration_pps2: ArrayLike) -> FloatArray:
        """The part of the available torque that is left: 1 nothing asked, 0 all of it, below 0 too much."""
        available = self.available_nm(velocity_pps)
        asked = np.abs(self.required_nm(velocity_pps, acceleration_pps2))
        left = 1 - np.divide(asked, available, out=np.full_like(asked, np.inf), where=available > 0)
        return np.asarray(left)

    def accelerations(self, velocity_pps: ArrayLike, margin: float) -> tuple[FloatArray, FloatArray]:
        """The highest acceleration and deceleration at a speed that leave `margin` [pps^2]; 0 where none does."""
        usable = (1 - margin) * self.available_nm(velocity_pps)
        resisting = self.resisting_nm(velocity_pps)
        per_torque = 1 / (self.inertia_kgm2 * self.microstep_rad)
        return np.maximum(usable - resisting, 0.0) * per_torque, (usable + resisting) * per_torque


@dataclass(frozen=True)
class FastMove:
    """The fastest move of its kind: its time [s], peak velocity [pps] and, of a trapezoid, its rates [pps^2]."""

    duration_s: float
    vmax: float
    amax: float
    dmax: float


def fastest_trapezoid(motor: StepperMotor, distance: float, vmax: float, margin: float) -> FastMove | None:
    """From rest to rest with one acceleration and one deceleration that leave `margin` at every speed it passes.

    distance : microsteps, any sign; vmax : not to be exceeded [pps]
    None where the motor cannot move at all with that margin.
    """
    peaks = np.linspace(0, vmax, _GRID + 1)[1:]
    up, down = motor.accelerations(np.concatenate(([0.0], peaks)), margin)
    # the torque falls with speed, what resists grows: but the least over the way is what holds, whatever the motor
    up, down = np.minimum.accumulate(up)[1:], np.minimum.accumulate(down)[1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        slopes = 1 / up + 1 / down
        cruise = abs(distance) / peaks - peaks * slopes / 2
        duration = cruise + peaks * slopes
    duration[~(cruise >= 0) | ~np.isfinite(duration)] = np.inf
    best = int(np.argmin(duration))
    if not np.isfinite(duration[best]):
        return _triangle(abs(distance), float(up[0]), float(down[0]))
    return FastMove(float(duration[best]), float(peaks[best]), float(up[best]), float(down[best]))


def _triangle(way: float, up: float, down: float) -> FastMove | None:
    """A move that is over below the first speed of the grid."""
    if not (up > 0 and down > 0 and way > 0):
        return None
    peak = math.sqrt(2 * way / (1 / up + 1 / down))
    return FastMove(peak * (1 / up + 1 / down), peak, up, down)


def fastest_move(motor: StepperMotor, distance: float, vmax: float, margin: float) -> FastMove | None:
    """From rest to rest with all the torque that leaves `margin`, at every speed anew: no ramp of a chip is faster.

    As `fastest_trapezoid`; the rates of the answer are those at rest.
    """
    speeds = np.linspace(0, vmax, _GRID + 1)
    up, down = motor.accelerations(speeds, margin)
    reached = int(np.argmin(up > 0)) if np.any(up <= 0) else len(speeds)
    if reached < 2:
        return None
    speeds, up, down = speeds[:reached], up[:reached], down[:reached]
    step = speeds[1]
    inverse = 1 / up + 1 / down
    time = np.concatenate(([0.0], np.cumsum((inverse[1:] + inverse[:-1]) / 2 * step)))
    moments = speeds * inverse
    way = np.concatenate(([0.0], np.cumsum((moments[1:] + moments[:-1]) / 2 * step)))
    wanted = abs(distance)
    if way[-1] <= wanted:
        duration, peak = time[-1] + (wanted - way[-1]) / speeds[-1], speeds[-1]
    elif wanted < way[1]:
        return _triangle(wanted, float(up[0]), float(down[0]))
    else:
        duration, peak = np.interp(wanted, way, time), np.interp(wanted, way, speeds)
    return FastMove(float(duration), float(peak), float(up[0]), float(down[0]))
