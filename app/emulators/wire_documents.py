"""What may be wrong on the wire of an emulated module, as it is told and changed."""

from __future__ import annotations

from pydantic import Field

from .drive.documents import ChipFaultsState, Closed, Flag, Rate
from .line.faults import Late


class WireFaultsChange(Closed):
    """Faults on the wire."""

    silence: Flag | None = Field(default=None, description="commands are obeyed, answers are lost")
    late_reply_s: Late | None = Field(
        default=None, description="answers come this much later [s]; without a real line they count as lost"
    )
    bit_error_rate: Rate | None = Field(default=None, description="probability that a bit of an answer is flipped")
    half_frame_rate: Rate | None = Field(default=None, description="probability that an answer breaks off half way")
    unplugged: Flag | None = Field(default=None, description="the line is gone: nothing is heard, nothing answered")


class WireFaultsState(ChipFaultsState):
    """What is wrong on the wire at present."""

    late_reply_s: float
    half_frame_rate: float
