"""The two sides of a drive that no register shows: what is done to it, and how it really is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Switches:
    """Which switches are pressed: by the carriage, or forced."""

    left: bool
    right: bool
    home: bool


class World(Protocol):
    """What a bench does to the drive while it runs: plain attributes, read and set at any time.

    A change holds from the next tick on. Setting one out of range raises ValueError.
    """

    load_torque_nm: float
    """Constant torque [N m], like a weight: a positive one pulls the shaft to negative positions."""
    extra_friction_nm: float
    """Coulomb friction on top of motor and load [N m], >= 0."""
    blocked: bool
    """The shaft is clamped where it is."""
    supply_v: float
    """Motor supply [V], 0..60. Below 8 V the chip reports GSTAT.uv_cp and switches its bridges off."""
    encoder_slip_fullsteps: float
    """How far the internal encoder's magnet has slipped on the shaft [full steps], in all."""
    external_slip_fullsteps: float
    """The same of the external encoder."""
    eccentricity_deg: float
    """Once-a-turn error of the internal encoder [deg of the shaft], amplitude."""
    left_at_fullsteps: float
    right_at_fullsteps: float
    home_from_fullsteps: float
    home_to_fullsteps: float
    """Places of the switches [full steps of the rotor]."""
    force_left: bool | None
    force_right: bool | None
    force_home: bool | None
    """Forced switches: None leaves them to the stage."""
    rotor_fullsteps: float
    """Where the rotor is [full steps]; setting it turns the shaft by hand (and stops it)."""
    motor_connected: bool
    """Unplugged, both coils carry nothing, and ola and olb are reported."""
    temperature_c: float
    """Of the bridges [deg C]: warning (otpw) from 120, shutdown (ot) from 150 until below 120."""


@dataclass(frozen=True, slots=True)
class Truth:
    """How motor and shaft really are, at the last tick."""

    rotor_rad: float
    """Shaft angle [rad], not wrapped."""
    rotor_fullsteps: float
    """The same in full steps: what the stage's switches look at."""
    speed_rad_s: float
    current_a_a: float
    current_b_a: float
    """Coil currents [A]: A follows the table's sine, B its cosine."""
    voltage_a_v: float
    voltage_b_v: float
    """Voltage across the coils in the last physics step [V]."""
    torque_nm: float
    """Electromagnetic torque, detent not included [N m]."""
    field_fullsteps: float
    """Commanded field [full steps, not wrapped]: where an ideal unloaded rotor would stand."""
    load_angle_deg: float
    """Field minus rotor [deg electrical], -180..180; 90 is one full step, and the most that holds."""
    lost_fullsteps: int
    """Full steps that the rotor fell behind (> 0) or got ahead, since power-on: multiples of 4."""
    current_scale: int
    """CS that the driver uses now, 0..31."""
    bridges: str
    """"regulated", "open" or "shorted"."""
