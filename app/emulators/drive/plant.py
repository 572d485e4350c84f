"""The plant of an emulated drive: what acts on motor and stage while it runs, and the state that no register shows."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Self, overload

from ...number_text import plain
from . import kernel as k
from .options import DriveOptions

UNDERVOLTAGE_V = 8.0
"""Below this supply the chip cannot drive its bridges [V]."""
OT_C, OTPW_C = 150.0, 120.0
"""Shutdown; warning, below which a shutdown ends [deg C]."""


@dataclass(frozen=True, slots=True)
class Switches:
    """Which switches are pressed: by the carriage, or forced."""

    left: bool
    right: bool
    home: bool


@dataclass(frozen=True, slots=True)
class PlantState:
    """State of motor and shaft at the last tick."""

    rotor_rad: float
    """Shaft angle [rad], not wrapped."""
    rotor_fullsteps: float
    """The same in full steps."""
    load_fullsteps: float
    """Where the load is [full steps]: what the stage's switches look at. The rotor's place where nothing gives."""
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
    """"regulated", "open", "shorted" or "voltage"."""
    supply_v: float
    """Motor supply at the driver [V]: less than `Plant.supply_v` where it sags."""


class _Number:
    """An attribute of `Plant` within limits; setting it tells the drive."""

    def __init__(self, low: float, high: float) -> None:
        self.low, self.high = low, high

    def __set_name__(self, owner: type[Plant], name: str) -> None:
        self.name = name

    @overload
    def __get__(self, plant: None, owner: type[Plant]) -> Self: ...
    @overload
    def __get__(self, plant: Plant, owner: type[Plant]) -> float: ...
    def __get__(self, plant: Plant | None, owner: type[Plant]) -> float | Self:
        return self if plant is None else plant.numbers[self.name]

    def __set__(self, plant: Plant, value: float) -> None:
        if not self.low <= value <= self.high:
            raise ValueError(f"{self.name} is {plain(value)}, allowed is {plain(self.low)}..{plain(self.high)}")
        plant.numbers[self.name] = float(value)
        plant.push()


class _Force:
    """A switch that can be forced: True, False, or None for the stage's."""

    def __init__(self, bit: int) -> None:
        self.bit = bit

    @overload
    def __get__(self, plant: None, owner: type[Plant]) -> Self: ...
    @overload
    def __get__(self, plant: Plant, owner: type[Plant]) -> bool | None: ...
    def __get__(self, plant: Plant | None, owner: type[Plant]) -> bool | Self | None:
        if plant is None:
            return self
        return bool(plant.forced & self.bit) if plant.force & self.bit else None

    def __set__(self, plant: Plant, value: bool | None) -> None:
        plant.force &= ~self.bit
        plant.forced &= ~self.bit
        if value is not None:
            plant.force |= self.bit
            plant.forced |= self.bit * value
        plant.push()


Short = Literal["none", "a", "b"]


class Plant:
    """What acts on the drive from outside while it runs: plain attributes, read and set at any time.

    A change holds from the next tick on. Setting one out of range raises ValueError.
    """

    load_torque_nm = _Number(-50.0, 50.0)
    """Constant torque [N m], like a weight: a positive one pulls the shaft to negative positions."""
    extra_friction_nm = _Number(0.0, 50.0)
    """Coulomb friction on top of motor and load [N m]."""
    supply_v = _Number(0.0, 60.0)
    """Motor supply [V]. Below 8 V the chip reports GSTAT.uv_cp and switches its bridges off."""
    encoder_slip_fullsteps = _Number(-1e7, 1e7)
    """How far the internal encoder's magnet has slipped on the shaft [full steps], in all."""
    external_slip_fullsteps = _Number(-1e7, 1e7)
    """The same of the external encoder."""
    eccentricity_deg = _Number(0.0, 10.0)
    """Once-a-turn error of the internal encoder [deg of the shaft], amplitude."""
    left_at_fullsteps = _Number(-1e7, 1e7)
    """The left switch is pressed here and to the left [full steps of the rotor]."""
    right_at_fullsteps = _Number(-1e7, 1e7)
    """The right switch is pressed here and to the right."""
    home_from_fullsteps = _Number(-1e7, 1e7)
    home_to_fullsteps = _Number(-1e7, 1e7)
    """The home switch is pressed between these."""
    temperature_c = _Number(-55.0, 250.0)
    """Of the bridges [deg C]: warning (otpw) from 120, shutdown (ot) from 150 until below 120."""
    force_left = _Force(1)
    """True or False: forced; None: left to the stage."""
    force_right = _Force(2)
    force_home = _Force(4)

    def __init__(self, options: DriveOptions, s: k.Cells, f: k.Floats, changed: Callable[[], None]) -> None:
        """`s` and `f` are the kernel's cells; `changed` is called after each change."""
        self._options, self._s, self._f, self._changed = options, s, f, changed
        stage = options.stage
        self.force = self.forced = 0
        self._blocked, self._connected = False, True
        self._short: Short = "none"
        self.numbers = {
            "load_torque_nm": options.load.torque_nm,
            "extra_friction_nm": 0.0,
            "supply_v": options.supply_v,
            "encoder_slip_fullsteps": 0.0,
            "external_slip_fullsteps": 0.0,
            "eccentricity_deg": options.encoders.eccentricity_deg,
            "left_at_fullsteps": stage.left_at_fullsteps,
            "right_at_fullsteps": stage.right_at_fullsteps,
            "home_from_fullsteps": stage.home_from_fullsteps,
            "home_to_fullsteps": stage.home_to_fullsteps,
            "temperature_c": 40.0,
        }

    @property
    def blocked(self) -> bool:
        """The shaft is clamped where it is."""
        return self._blocked

    @blocked.setter
    def blocked(self, value: bool) -> None:
        self._blocked = bool(value)
        self.push()

    @property
    def motor_connected(self) -> bool:
        """Unplugged, both coils carry nothing, and DRV_STATUS reports ola and olb."""
        return self._connected

    @motor_connected.setter
    def motor_connected(self, value: bool) -> None:
        self._connected = bool(value)
        self.push()

    @property
    def short_to_ground(self) -> Short:
        """The coil that is shorted to ground: the driver shuts down and reports it."""
        return self._short

    @short_to_ground.setter
    def short_to_ground(self, value: Short) -> None:
        self._short = value
        self.push()

    @property
    def rotor_fullsteps(self) -> float:
        """Where the rotor is [full steps]; setting it turns the shaft by hand (and stops it)."""
        return float(self._f[k.THETA]) / self.fullstep_rad

    @rotor_fullsteps.setter
    def rotor_fullsteps(self, value: float) -> None:
        if not abs(value) <= 1e7:
            raise ValueError(f"rotor_fullsteps is {plain(value)}, allowed is -1e7..1e7")
        self._f[k.THETA] = value * self.fullstep_rad
        self._f[k.LOAD_THETA] = self._f[k.THETA]
        self._f[k.OMEGA] = self._f[k.LOAD_OMEGA] = 0.0
        self.push()

    @property
    def driver_supply_v(self) -> float:
        """Motor supply at the driver now [V]: less than `supply_v` where it sags."""
        return float(self._f[k.SUPPLY])

    @property
    def fullstep_rad(self) -> float:
        """A full step of the rotor [rad]."""
        return math.pi / 2 / self._options.motor.rotor_teeth

    def refit(self, options: DriveOptions) -> None:
        """Another motor or load from now on; what was set here stays."""
        self._options = options
        self.push()

    def push(self) -> None:
        """Hand everything to the kernel."""
        f, numbers, motor, load = self._f, self.numbers, self._options.motor, self._options.load
        step = self.fullstep_rad
        if f[k.SOURCE] != numbers["supply_v"] or not self._options.supply_resistance_ohm:
            f[k.SOURCE] = f[k.SUPPLY] = numbers["supply_v"]
        f[k.LOAD] = numbers["load_torque_nm"]
        f[k.E1] = math.radians(numbers["eccentricity_deg"])
        friction = motor.friction_nm + load.friction_nm + numbers["extra_friction_nm"]
        if self._s[k.COUPLED]:
            f[k.LOAD_TORQUE], f[k.LOAD] = f[k.LOAD], 0.0
            f[k.LOAD_FRICTION] = (friction - motor.friction_nm) * f[k.LOAD_DT_J]
            f[k.LOAD_STICTION] = f[k.LOAD_FRICTION] * motor.stiction_ratio
            friction = motor.friction_nm
        f[k.FRICTION] = friction * f[k.DT_J] * f[k.DAMP]
        f[k.STICTION] = f[k.FRICTION] * motor.stiction_ratio
        f[k.SLIP_I] = numbers["encoder_slip_fullsteps"] * step
        f[k.SLIP_E] = numbers["external_slip_fullsteps"] * step
        f[k.LEFT_AT], f[k.RIGHT_AT] = numbers["left_at_fullsteps"] * step, numbers["right_at_fullsteps"] * step
        f[k.HOME_FROM], f[k.HOME_TO] = numbers["home_from_fullsteps"] * step, numbers["home_to_fullsteps"] * step
        f[k.SWITCH_PLAY] = self._options.stage.backlash_fullsteps * step
        self._s[k.FORCE], self._s[k.FORCED], self._s[k.BLOCKED] = self.force, self.forced, self._blocked
        if self._blocked:
            f[k.OMEGA] = 0.0
        self._changed()
