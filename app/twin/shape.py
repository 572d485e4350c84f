"""What is known of an axis that is shown: its mechanics, and its numbers at one moment.

Numbers that a family does not measure are None, and stay None through everything here: a part without data is drawn
grey and says so, it is never made up.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any, Literal

FieldSource = Literal["mscnt", "currents", "position"]
Coil = Literal["a", "b"]
LoadSource = Literal["load_angle", "deviation"]
CURRENT_FULL = 256.0
"""What the channels `current_a` and `current_b` count a full coil current as."""
MSCNT_TURN = 1024.0
FIELD_LEAST = 0.02
"""Share of the full current below which two coils do not point anywhere."""

CHANNELS = (
    "position",
    "encoder_position",
    "deviation",
    "mscnt",
    "current_a",
    "current_b",
    "load_angle",
    "velocity",
    "switch_left",
    "switch_right",
    "switch_home",
    "switch_reference",
)
"""Quantities that the twin shows, of whichever an axis has."""


def sine_coil_of(model: str) -> Coil:
    """The coil that carries the sine: B of a TMC5xxx (its CUR_B), A of all others."""
    return "b" if model.startswith("tmc5") else "a"


@dataclass(frozen=True, slots=True)
class Shape:
    """One axis from the motor to the load.

    microsteps : microsteps per full step [-]; None while nobody knows
    gear_ratio : motor revolutions per output revolution [-]
    travel_mm_per_rev : travel per output revolution [mm]; None: a rotary table
    limits : soft limits of the position [microsteps]; None where there is none
    sine_coil : the coil whose current is the sine of the microstep counter; the other one's is the cosine
    channels : the quantities that this axis has at all
    """

    device: str
    axis: int
    name: str
    full_steps_per_rev: int = 200
    microsteps: int | None = None
    gear_ratio: float = 1.0
    travel_mm_per_rev: float | None = None
    limits: tuple[float | None, float | None] = (None, None)
    sine_coil: Coil = "a"
    channels: frozenset[str] = frozenset()

    @property
    def linear(self) -> bool:
        """Whether it is a stage with a carriage, else a rotary table."""
        return self.travel_mm_per_rev is not None

    def motor_deg(self, microsteps: float | None) -> float | None:
        """A position as the angle of the motor's shaft [degrees]."""
        if microsteps is None or self.microsteps is None:
            return None
        return microsteps * 360.0 / (self.full_steps_per_rev * self.microsteps)

    def place(self, microsteps: float | None) -> float | None:
        """A position as travel of the carriage [mm], or as angle of the table [degrees]."""
        motor_deg = self.motor_deg(microsteps)
        if motor_deg is None:
            return None
        return motor_deg / self.gear_ratio * (1.0 if self.travel_mm_per_rev is None else self.travel_mm_per_rev / 360.0)

    def electrical_deg(self, microsteps: float | None) -> float | None:
        """A way as electrical angle [degrees]: four full steps are a turn."""
        return None if microsteps is None or self.microsteps is None else microsteps * 90.0 / self.microsteps

    def message(self) -> dict[str, Any]:
        """As JSON, for the process that draws."""
        return {**asdict(self), "channels": sorted(self.channels)}

    @classmethod
    def of_message(cls, message: Mapping[str, Any]) -> Shape:
        """The inverse of `message`."""
        return cls(**{**message, "limits": tuple(message["limits"]), "channels": frozenset(message["channels"])})


@dataclass(frozen=True, slots=True)
class Travel:
    """Which stretch of a stage is drawn, and where its switches seem to be [mm]; None: not seen yet."""

    from_mm: float
    to_mm: float
    left_mm: float | None = None
    right_mm: float | None = None
    home_mm: float | None = None


@dataclass(frozen=True, slots=True)
class Slips:
    """Steps that the rotor lost against its field since the view began."""

    lost_full_steps: int = 0
    """Net: positive where the rotor fell behind a field that turns forward."""
    events: int = 0
    last_s: float | None = None
    """When the last one happened, device time."""


@dataclass(frozen=True, slots=True)
class AxisPose:
    """An axis at one moment, as numbers; None: not measured, or not known now.

    Angles of the field are electrical: four full steps are a turn. `place` is mm of a stage, degrees of a table.
    """

    time_s: float | None = None
    position: float | None = None
    velocity_pps: float | None = None
    commanded_deg: float | None = None
    measured_deg: float | None = None
    place_commanded: float | None = None
    place_measured: float | None = None
    field_deg: float | None = None
    field_from: FieldSource | None = None
    field_share: float | None = None
    """Length of the field vector against full current in one coil; None where no current is measured."""
    load_deg: float | None = None
    """How far the field leads the rotor; beyond a half turn the rotor has slipped."""
    load_from: LoadSource | None = None
    current_a: float | None = None
    current_b: float | None = None
    """Shares of the full coil current, -1..1."""
    switch_left: bool | None = None
    switch_right: bool | None = None
    switch_home: bool | None = None
    slips: Slips | None = None
    """None where no encoder tells."""
    travel: Travel | None = field(default=None)

    @property
    def rotor_deg(self) -> float | None:
        """Where the rotor's own field points, electrical [degrees]."""
        return None if self.field_deg is None or self.load_deg is None else (self.field_deg - self.load_deg) % 360.0

    @property
    def slip_age_s(self) -> float | None:
        """How long ago the last slip was [s]; None where there was none."""
        if self.slips is None or self.slips.last_s is None or self.time_s is None:
            return None
        return max(0.0, self.time_s - self.slips.last_s)

    def message(self) -> dict[str, Any]:
        """As JSON, for the process that draws."""
        return {name: value for name, value in asdict(self).items() if value is not None}

    @classmethod
    def of_message(cls, message: Mapping[str, Any]) -> AxisPose:
        """The inverse of `message`."""
        known = {entry.name for entry in fields(cls)}
        values = {name: value for name, value in message.items() if name in known}
        if "slips" in values:
            values["slips"] = Slips(**values["slips"])
        if "travel" in values:
            values["travel"] = Travel(**values["travel"])
        return cls(**values)


def look_of(
    shape: Shape,
    time_s: float | None,
    values: Mapping[str, float],
    slips: Slips | None = None,
    travel: Travel | None = None,
) -> AxisPose:
    """The numbers of one sample: `values` by quantity in the units of the telemetry channels, NaN where missing."""

    def value(quantity: str) -> float | None:
        found = values.get(quantity, math.nan)
        return found if math.isfinite(found) else None

    def closed(*quantities: str) -> bool | None:
        return next((found > 0.5 for found in map(value, quantities) if found is not None), None)

    position, encoder = value("position"), value("encoder_position")
    current_a, current_b = (
        None if found is None else max(-1.0, min(1.0, found / CURRENT_FULL))
        for found in (value("current_a"), value("current_b"))
    )
    field_deg, field_from, field_share = _field(shape, value("mscnt"), position, current_a, current_b)
    load_deg, load_from = _load(value("load_angle"), shape.electrical_deg(value("deviation")))
    return AxisPose(
        time_s=time_s,
        position=position,
        velocity_pps=value("velocity"),
        commanded_deg=shape.motor_deg(position),
        measured_deg=shape.motor_deg(encoder),
        place_commanded=shape.place(position),
        place_measured=shape.place(encoder),
        field_deg=field_deg,
        field_from=field_from,
        field_share=field_share,
        load_deg=load_deg,
        load_from=load_from,
        current_a=current_a,
        current_b=current_b,
        switch_left=closed("switch_left"),
        switch_right=closed("switch_right"),
        switch_home=closed("switch_home", "switch_reference"),
        slips=slips if value("deviation") is not None else None,
        travel=travel,
    )


def _field(
    shape: Shape, mscnt: float | None, position: float | None, current_a: float | None, current_b: float | None
) -> tuple[float | None, FieldSource | None, float | None]:
    """Direction of the stator's field [electrical degrees], what tells it, and its length where currents do.

    One coil carries the sine of the microstep counter and the other one its cosine: this lies along 0, that along 90.
    """
    share = None if current_a is None or current_b is None else math.hypot(current_a, current_b)
    if mscnt is not None:
        return mscnt * 360.0 / MSCNT_TURN % 360.0, "mscnt", share
    if current_a is not None and current_b is not None and share is not None and share >= FIELD_LEAST:
        sine, cosine = (current_a, current_b) if shape.sine_coil == "a" else (current_b, current_a)
        return math.degrees(math.atan2(sine, cosine)) % 360.0, "currents", share
    electrical = shape.electrical_deg(position)
    return (None, None, share) if electrical is None else (electrical % 360.0, "position", share)


def _load(load_angle: float | None, deviation_deg: float | None) -> tuple[float | None, LoadSource | None]:
    """How far the field leads the rotor [electrical degrees]: as the family says, else what the encoder lags by."""
    if load_angle is not None:
        return load_angle, "load_angle"
    return (None, None) if deviation_deg is None else (-deviation_deg, "deviation")
