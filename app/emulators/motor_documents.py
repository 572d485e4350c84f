"""What emulators with a motor have in common: what they can be asked for, and what is changed in while they run."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ..errors import WrongState
from ..form_hints import shown
from .drive.documents import (
    Closed,
    Flag,
    Friction,
    MotorChange,
    Seed,
    Supply,
    TimeScale,
    Torque,
    change_motor,
    forced,
)
from .drive.options import FullSteps, LoadOptions, MotorOptions, SupplyResistance
from .drive.plant import Plant

Rigid = Literal["rigid"]
NoiseSeed = Annotated[
    Seed, Field(title="Seed of noise and faults", description="of the noise in the load value and of bit errors")
]


class MotorDocument(Closed):
    """How an emulator with a motor is made."""

    time_scale: TimeScale = shown(1.0, "Time runs at", "how fast its time passes; 0 stands still", unit="x real time")
    supply_v: Supply = shown(24.0, "Supply", "motor supply [V]")
    supply_resistance_ohm: SupplyResistance = 0.0
    seed: NoiseSeed = 5160
    start_fullsteps: FullSteps = shown(0.0, "Rotor at first", "where the rotor stands at first [full steps]")
    motor: MotorOptions | Rigid = Field(
        default_factory=MotorOptions,
        title="Motor and load",
        description='"rigid": no physics, the shaft follows the field exactly, and long stretches at constant velocity '
        "take no time to work out",
    )
    load: LoadOptions = Field(default_factory=LoadOptions, title="Motor and load")

    @property
    def rigid(self) -> bool:
        """Whether the shaft follows the field exactly."""
        return self.motor == "rigid"

    @property
    def physics(self) -> MotorOptions:
        """The motor, of a rigid one what it would be."""
        return MotorOptions() if isinstance(self.motor, str) else self.motor


class LoadChange(Closed):
    """A motor and its load; what is left out stays."""

    motor: MotorChange = Field(default_factory=MotorChange)
    load_torque_nm: Torque | None = Field(
        default=None, description="constant, like a weight: a positive one pulls to negative positions [N m]"
    )
    blocked: Flag | None = Field(default=None, description="clamps the shaft where it is")
    friction: Friction | None = Field(default=None, description="friction on top of the motor's own [N m]")


def require_physics(rigid: bool, wanted: LoadChange) -> None:
    """Raises WrongState for a load on a rigid motor."""
    if rigid and (wanted.load_torque_nm or wanted.friction or wanted.blocked):
        raise WrongState("the motor is rigid", "make the emulator with a motor that has physics")


def change_load(plant: Plant, wanted: LoadChange) -> None:
    """Motor and load; it has been checked."""
    change_motor(plant, wanted.motor)
    if wanted.load_torque_nm is not None:
        plant.load_torque_nm = wanted.load_torque_nm
    if wanted.friction is not None:
        plant.extra_friction_nm = wanted.friction
    if wanted.blocked is not None:
        plant.blocked = wanted.blocked


def force_switches(plant: Plant, wanted: Closed) -> None:
    """Those that `wanted`, a document with a field a switch, names."""
    for name, level in wanted.model_dump(exclude_none=True).items():
        setattr(plant, f"force_{name}", forced(level))
