"""What a line does to the bytes on it."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Field

from ...deferred import DeferredModel

Rate = Annotated[float, Field(strict=True, ge=0, le=1, allow_inf_nan=False)]
Late = Annotated[float, Field(strict=True, ge=0, le=60, allow_inf_nan=False)]
Switch = Annotated[bool, Field(strict=True)]


class _Closed(DeferredModel):
    model_config = ConfigDict(extra="forbid")


class LineFaults(_Closed):
    """Faults of the cable itself: unlike those of one module they hit every module, and questions too."""

    silence: Switch = Field(default=False, description="no answer arrives, of any module; all of them obey")
    late_reply_s: Late = Field(default=0.0, description="how much too late every answer comes [s]")
    bit_error_rate: Rate = Field(default=0.0, description="probability that a bit is flipped, in either direction")
    half_frame_rate: Rate = Field(default=0.0, description="probability that an answer breaks off after 1..8 bytes")
    unplugged: Switch = Field(default=False, description="the cable is out: the port is gone")


class LineFaultsChange(_Closed):
    """A change of some of the faults."""

    silence: Switch | None = None
    late_reply_s: Late | None = None
    bit_error_rate: Rate | None = None
    half_frame_rate: Rate | None = None
    unplugged: Switch | None = None


class LineState(_Closed):
    """A line, and who hangs on it."""

    baud: int | None = Field(description="bits a second of the wire; null: as fast as it goes")
    shared_bus: bool = Field(description="every client hears everything, as on RS485")
    addresses: list[int] = Field(description="the modules, by the address that they were started with")
    plugged: bool = Field(description="whether the port is there")
    faults: LineFaults


class LinePatch(_Closed):
    """A change to a line; what is left out stays."""

    baud: Annotated[int, Field(strict=True, ge=300, le=4_000_000)] | None = None
    faults: LineFaultsChange = Field(default_factory=LineFaultsChange)
