"""Shapes of wires between emulators."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from ..schemas import Answer


class NetPin(Answer):
    """A pin on a net."""

    device: str = Field(validation_alias="key", description="id of the device")
    pin: str = Field(description="START, or STEP1 to STEP3: step and direction of an axis")
    role: Literal["level", "output", "input"] = Field(description="level: either way, as the chip is set")


class Net(Answer):
    """Pins of emulated devices that are wired together: those whose options (`wires`) name the same net."""

    net: str
    pins: list[NetPin]
    open: str | None = Field(description="why it connects nothing; null where it does")
    equal_clocks: bool = Field(
        description="an edge is seen at the very clock of the others; false: rounded to a clock of whoever sees it"
    )


class Wiring(Answer):
    """All nets, by name."""

    nets: list[Net]
