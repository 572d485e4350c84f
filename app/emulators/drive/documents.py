"""Parts of the REST documents of emulated motors, and what is done with them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import ConfigDict, Field

from ...deferred import DeferredModel
from ...errors import OutOfRange
from ..core.ground_truth import GroundTruth
from .options import FullSteps, MotorOptions
from .plant import Plant, PlantState, Short

Flag = Annotated[bool, Field(strict=True)]
Forced = Flag | Literal["auto"]
Rate = Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)]
Torque = Annotated[float, Field(strict=True, ge=-50, le=50, allow_inf_nan=False)]
Friction = Annotated[float, Field(strict=True, ge=0, le=50, allow_inf_nan=False)]
Supply = Annotated[float, Field(strict=True, ge=0, le=60, allow_inf_nan=False)]
Seed = Annotated[int, Field(strict=True, ge=0, le=2**32 - 1)]
TimeScale = Annotated[float, Field(strict=True, ge=0, le=20, allow_inf_nan=False)]
"""A motor that turns is worked out 50 times as fast as it turns, or more; beyond that it would never be caught up."""

PLACES = ("left_at_fullsteps", "right_at_fullsteps", "home_from_fullsteps", "home_to_fullsteps")
"""Where the switches of a stage are: names in options, changes, states and in `Plant`."""


class Closed(DeferredModel):
    """A document that takes nothing that it does not name."""

    model_config = ConfigDict(extra="forbid")


# --- what is told ---------------------------------------------------------------------------------


class MotorState(DeferredModel):
    connected: bool
    temperature_c: float = Field(description="of the driver's bridges [deg C]")
    short_to_ground: Short = Field(description="the coil that is shorted to ground")
    fullsteps_per_turn: int
    torque_constant_nm_a: float = Field(description="of one phase, peak values; also back-EMF constant [V s/rad]")
    holding_torque_nm: float = Field(description="both coils at rated current [N m]")
    rated_current_a: float = Field(description="in both coils [A]")
    figures: dict[str, float] = Field(
        description="all of this motor by the names of its options, of one of a batch as they were drawn"
    )


class StageState(DeferredModel):
    """Where switches and carriage are [full steps of the rotor]."""

    left_at_fullsteps: float
    right_at_fullsteps: float
    home_from_fullsteps: float
    home_to_fullsteps: float
    position_fullsteps: float = Field(description="where the carriage really is")


class TruthState(DeferredModel):
    """How motor and shaft really are: what nobody tells who is asked over the wire."""

    rotor_rad: float = Field(description="shaft angle, not wrapped [rad]")
    rotor_fullsteps: float = Field(description="the same in full steps")
    field_fullsteps: float = Field(description="where an ideal unloaded rotor would stand [full steps]")
    speed_rad_s: float
    load_angle_deg: float = Field(description="field minus rotor [deg electrical]; more than 90 does not hold")
    current_a_a: float = Field(description="coil A [A]")
    current_b_a: float = Field(description="coil B [A]")
    torque_nm: float
    lost_fullsteps: int = Field(description="full steps lost since power-on: multiples of four")
    current_scale: int = Field(description="current scale in use")
    bridges: str = Field(description='"regulated", "open", "shorted", or "voltage" while PWM drives them')
    load_fullsteps: float = Field(description="where the load is, behind what gives between it and the rotor")
    supply_v: float = Field(description="motor supply at the driver, where it may sag [V]")


class ChipFaultsState(DeferredModel):
    """What is wrong between a chip and us at present."""

    silence: bool
    unplugged: bool
    bit_error_rate: float


def motor_state(plant: Plant, motor: MotorOptions) -> MotorState:
    """The motor as the API tells it."""
    return MotorState(
        connected=plant.motor_connected,
        temperature_c=plant.temperature_c,
        short_to_ground=plant.short_to_ground,
        fullsteps_per_turn=4 * motor.rotor_teeth,
        torque_constant_nm_a=motor.torque_constant,
        holding_torque_nm=motor.holding_torque_nm,
        rated_current_a=motor.rated_current_a,
        figures=_figures(motor),
    )


def _figures(motor: MotorOptions) -> dict[str, float]:
    told = motor.model_dump(exclude={"open_phase", "batch_seed"})
    load = {f"load_value.{name}": value for name, value in told.pop("load_value").items()}
    return {**told, **load}


def stage_state(plant: Plant, state: PlantState) -> StageState:
    """Switches and carriage as the API tells them."""
    return StageState(
        left_at_fullsteps=plant.left_at_fullsteps,
        right_at_fullsteps=plant.right_at_fullsteps,
        home_from_fullsteps=plant.home_from_fullsteps,
        home_to_fullsteps=plant.home_to_fullsteps,
        position_fullsteps=state.load_fullsteps,
    )


def ground_truth(state: PlantState, plant: Plant) -> GroundTruth:
    """What no driver can know."""
    return GroundTruth(
        state.rotor_fullsteps,
        state.lost_fullsteps,
        plant.blocked,
        state.speed_rad_s / plant.fullstep_rad,
        state.bridges,
    )


def truth_state(state: PlantState) -> TruthState:
    """What no register tells, as the API tells it."""
    return TruthState(
        rotor_rad=state.rotor_rad,
        rotor_fullsteps=state.rotor_fullsteps,
        field_fullsteps=state.field_fullsteps,
        speed_rad_s=state.speed_rad_s,
        load_angle_deg=state.load_angle_deg,
        current_a_a=state.current_a_a,
        current_b_a=state.current_b_a,
        torque_nm=state.torque_nm,
        lost_fullsteps=state.lost_fullsteps,
        current_scale=state.current_scale,
        bridges=state.bridges,
        load_fullsteps=state.load_fullsteps,
        supply_v=state.supply_v,
    )


# --- what is changed ------------------------------------------------------------------------------


class MotorChange(Closed):
    connected: Flag | None = Field(default=None, description="false pulls the motor's plug")
    temperature_c: Annotated[float, Field(strict=True, ge=-40, le=250, allow_inf_nan=False)] | None = Field(
        default=None, description="of the driver's bridges: warning from 120, shutdown from 150 [deg C]"
    )
    short_to_ground: Short | None = Field(
        default=None, description="the coil that is shorted to ground: the driver shuts down, and says so"
    )


class StageChange(Closed):
    """Moves switches of the stage, or turns the shaft as by hand [full steps of the rotor]."""

    left_at_fullsteps: FullSteps | None = None
    right_at_fullsteps: FullSteps | None = None
    home_from_fullsteps: FullSteps | None = None
    home_to_fullsteps: FullSteps | None = None
    position_fullsteps: FullSteps | None = Field(default=None, description="turns the shaft there and stops it")


class ChipFaultsChange(Closed):
    """Faults between the chip and us."""

    silence: Flag | None = Field(default=None, description="datagrams are obeyed, answers are lost")
    unplugged: Flag | None = Field(default=None, description="the link is gone")
    bit_error_rate: Rate | None = Field(default=None, description="probability that a bit of a reply is flipped")


def check_stage(places: Mapping[str, float], wanted: StageChange) -> None:
    """Raises OutOfRange where switches, now at `places` (by the names in `PLACES`), would change places."""
    moved = {name: places[name] if getattr(wanted, name) is None else getattr(wanted, name) for name in PLACES}
    for low, high, touching in (
        ("left_at_fullsteps", "right_at_fullsteps", False),
        ("home_from_fullsteps", "home_to_fullsteps", True),
    ):
        if moved[low] > moved[high] or (moved[low] == moved[high] and not touching):
            raise OutOfRange(low, moved[low], None, moved[high], f"{high} lies to the right of it")


def places_of(plant: Plant) -> dict[str, float]:
    """Where the switches of a drive's stage are."""
    return {name: getattr(plant, name) for name in PLACES}


def change_motor(plant: Plant, wanted: MotorChange) -> None:
    """Plug and temperature."""
    if wanted.connected is not None:
        plant.motor_connected = wanted.connected
    if wanted.temperature_c is not None:
        plant.temperature_c = wanted.temperature_c
    if wanted.short_to_ground is not None:
        plant.short_to_ground = wanted.short_to_ground


def change_stage(plant: Plant, wanted: StageChange) -> None:
    """Switches, then the shaft; the stage has been checked."""
    for name in PLACES:
        place = getattr(wanted, name)
        if place is not None:
            setattr(plant, name, place)
    if wanted.position_fullsteps is not None:
        plant.rotor_fullsteps = wanted.position_fullsteps


def forced(wanted: Forced) -> bool | None:
    """As `Plant` counts it: None is the stage's."""
    return None if wanted == "auto" else wanted
