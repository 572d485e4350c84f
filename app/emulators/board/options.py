"""What can be said to an emulated board from outside: its plant, its faults, and those of its chip."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from ..drive.documents import Closed, Flag
from ..line.faults import Late, LineFaultsChange, Rate, Switch
from ..tmc5xxx.options import Tmc5xxxPatch
from ..tmc5xxx.state import Tmc5xxxState
from ..tmc4361.options import Tmc4361Patch
from ..tmc4361.state import Tmc4361State

MODEL = "landungsbruecke"
USUAL_CHIP = "tmc4361"
"""In its slot where none is named."""


class BoardFaults(Closed):
    """Between the board and its line. Faults of the SPI are the chip's."""

    silence: Switch = Field(default=False, description="the board obeys and says nothing")
    late_reply_s: Late = Field(default=0.0, description="how much too late every answer comes [s]")
    bit_error_rate: Rate = Field(default=0.0, description="probability that a bit of an answer is flipped")
    half_frame_rate: Rate = Field(default=0.0, description="probability that an answer breaks off after 1..8 bytes")
    unplugged: Switch = Field(default=False, description="the USB cable is out")


class BoardFaultsChange(LineFaultsChange):
    """A change of some of the faults."""


class BoardPatch(Closed):
    """A change to a running board; what is left out stays. A power cycle comes first."""

    faults: BoardFaultsChange = Field(default_factory=BoardFaultsChange)
    power_cycle: Flag = Field(default=False, description="board and chip off and on again; motor and stage stay")
    chip: Tmc4361Patch | Tmc5xxxPatch = Field(
        default_factory=Tmc4361Patch, description="the chip in the slot and its plant"
    )


class BoardState(Closed):
    """An emulated board and the chip in its slot."""

    model: Literal["landungsbruecke"] = "landungsbruecke"
    version: str
    faults: BoardFaults
    chip: Annotated[Tmc4361State | Tmc5xxxState, Field(discriminator="model")]
