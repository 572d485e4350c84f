"""Every chip that stepscope knows, by model name."""

from __future__ import annotations

from dataclasses import dataclass

from app.registers import tmc428, tmc4210
from app.registers.model import RegisterTable


@dataclass(frozen=True, slots=True)
class Model:
    """A chip: its name on the API, what it is, and its registers."""

    name: str
    title: str
    summary: str
    axes: int
    table: RegisterTable
    clock_hz_default: float
    clock_hz_max: float


MODELS = {
    model.name: model
    for model in (
        Model("tmc428", "TMC428", "three axes, SPI driver chain", tmc428.AXES, tmc428.TMC428, 16e6, 16e6),
        Model("tmc4210", "TMC4210", "one axis, step/direction", tmc4210.AXES, tmc4210.TMC4210, 16e6, 32e6),
    )
}
