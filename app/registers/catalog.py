"""Every chip and module that stepscope knows, by model name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from .model import RegisterTable
from .tmc5xxx import table as tmc5xxx
from .tmc428 import tmc428, tmc4210
from .tmc4361 import table as tmc4361
from .tmcl import pd42


@dataclass(frozen=True, slots=True)
class Model:
    """A chip or module: its name on the API, what it is, and its registers or parameters."""

    name: str
    title: str
    summary: str
    axes: int
    table: RegisterTable
    clock_hz_default: float
    clock_hz_max: float
    kind: Literal["chip", "module"] = "chip"
    """A chip has registers; a module speaks TMCL and has parameters."""
    datagram_bits: int = 32
    """Length of one datagram on the wire of a chip; 0 for a module, whose frames TMCL tells."""
    uart: Literal["", "plain", "node"] = ""
    """A chip's UART besides SPI: none, datagrams of one chip on a line, or with the address of one of several."""


def _tmc5xxx(number: int, summary: str, uart: Literal["", "plain", "node"]) -> Model:
    name = f"tmc{number}"
    return Model(
        name,
        name.upper(),
        summary,
        tmc5xxx.AXES[name],
        tmc5xxx.TABLES[name],
        tmc5xxx.CLOCK_HZ_DEFAULT,
        tmc5xxx.CLOCK_HZ_MAX,
        datagram_bits=40,
        uart=uart,
    )


MODELS = {
    model.name: model
    for model in (
        Model("tmc428", "TMC428", "three axes, SPI driver chain", tmc428.AXES, tmc428.TMC428, 16e6, 16e6),
        Model("tmc4210", "TMC4210", "one axis, step/direction", tmc4210.AXES, tmc4210.TMC4210, 16e6, 32e6),
        Model(
            "tmc4361",
            "TMC4361",
            "one axis, S-ramps, encoder and closed loop",
            tmc4361.AXES,
            tmc4361.TMC4361,
            tmc4361.CLOCK_HZ_DEFAULT,
            tmc4361.CLOCK_HZ_MAX,
            datagram_bits=40,
        ),
        _tmc5xxx(5031, "two axes, SixPoint ramps and drivers to 1.1 A; SPI", ""),
        _tmc5xxx(5062, "two axes, SixPoint ramps, drivers to 1.1 A and encoders; SPI, UART", "plain"),
        _tmc5xxx(5072, "two axes, SixPoint ramps, drivers to 1.1 A with StealthChop, encoders; SPI, UART", "node"),
        _tmc5xxx(5130, "one axis, SixPoint ramp, driver to 2 A with StealthChop, encoder; SPI, UART", "node"),
        _tmc5xxx(5160, "one axis, SixPoint ramp, gate driver with StealthChop, encoder; SPI, UART", "node"),
        Model(
            "pd42-1241",
            "PD42-1241",
            "motor, driver and encoder in one; TMCL over USB, RS485, CAN",
            pd42.AXES,
            pd42.PD42,
            pd42.CLOCK_HZ,
            pd42.CLOCK_HZ,
            "module",
            0,
        ),
    )
}
CHIPS_32 = {name: model for name, model in MODELS.items() if model.datagram_bits == 32}
"""TMC428 and TMC4210: one ramp generator, one kind of datagram, and so the same promises in most tests."""
