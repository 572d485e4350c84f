"""What a study of torque over speed tells."""

from __future__ import annotations

from pydantic import Field

from ..parts import Interval, Part


class TorquePoint(Part):
    """What the motor has at one speed, beyond the friction of its axis."""

    speed_rps: float = Field(description="at which steps are lost [turns/s]: of slips, midway from rotor to field")
    acceleration_radps2: float = Field(description="the most that it gives its load, mean of the ways [rad/s^2]")
    interval_radps2: Interval = Field(description="95 %")
    both_ways_radps2: float | None = Field(
        description="positive way less negative way: a weight, a spring; null where it was one way alone"
    )
    torque_nm: float | None = Field(default=None, description="null where the inertia was not told")
    interval_nm: Interval | None = Field(default=None, description="95 %, with that of the inertia")
    asked_rps: float | None = Field(default=None, description="the one of `speeds_rps` that it was looked for")
    slips: int = Field(description="runs that lost steps")


class RampMargin(Part):
    """The ramp that was set before, against what the motor has at its worst speed."""

    speed_rps: float = Field(description="where the least is left [turns/s]")
    acceleration_radps2: float = Field(description="that the ramp asks for")
    times: float = Field(description="so many times that is there")
    interval: Interval
    whole: bool = Field(description="whether the whole ramp lies within the speeds that were looked at")


class TorqueFound(Part):
    """Torque over speed."""

    inertia_kgm2: float | None = Field(description="of rotor and load, as told")
    friction_nm: float = Field(description="of the axis, as told: it is added to the torque")
    points: list[TorquePoint] = Field(default_factory=list)
    first_radps2: float | None = Field(default=None, description="what there is at the first speed, about")
    speeds_rps: list[float] = Field(default_factory=list, description="at which it looks, as soon as that is known")
    margin: RampMargin | None = None
    speed_most_rps: float | None = Field(default=None, description="where a gentle acceleration lost steps [turns/s]")
    at_least_radps2: float | None = Field(
        default=None, description="null where steps were lost; else the most that the chip can, and none were"
    )
