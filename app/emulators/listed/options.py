"""What a plain emulated module can be asked for when it is made, changed in while it runs, and what it tells."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Field

from ...deferred import DeferredModel
from ...form_hints import REST_ONLY, form, rest_only, shown
from ..core.base import EmulatedState
from ..drive.documents import Closed, Flag, Seed, TimeScale
from ..wire_documents import WireFaultsChange, WireFaultsState

PLAIN = (
    "plain: parameters hold what was written, and axes move by their own speed and acceleration; no motor, no driver"
)
PLAIN_CHIP = (
    "plain: registers hold what was written, and a ramp generator moves by its own speed and acceleration; no motor, "
    "no driver, no flags"
)


class ListedOptions(Closed):
    """How a plain emulated chip or module is made: the `link` of an emulated device."""

    model_config = ConfigDict(json_schema_extra=form(fold="time"))

    time_scale: TimeScale = shown(1.0, "Time runs at", "how fast its time passes; 0 stands still", unit="x real time")
    address: Annotated[int, Field(strict=True, ge=1, le=255)] = rest_only(1, "serial address")
    node: Annotated[int, Field(strict=True, ge=0, le=254)] = rest_only(0, "of a chip with a UART: its node address")
    unknown_parameters: Annotated[list[Annotated[int, Field(strict=True, ge=0, le=255)]], Field(max_length=256)] = (
        Field(
            default_factory=list,
            description="axis parameters that its firmware, as another version, does not have: answered with status 3",
            json_schema_extra=REST_ONLY,
        )
    )
    seed: Seed = rest_only(1241, "of the noise that faults on the wire make")


class ListedPatch(Closed):
    """A change to a plain emulated chip or module; what is left out stays. A power cycle comes first."""

    time_scale: TimeScale | None = None
    faults: WireFaultsChange = Field(default_factory=WireFaultsChange)
    power_cycle: Flag = Field(default=False, description="off and on again; what was stored comes back")


class ListedAxisState(DeferredModel):
    position: float = Field(description="where the axis is, in its counts")
    velocity: float = Field(description="how fast it goes [counts/s]")


class ListedState(EmulatedState):
    """Everything that GET .../emulator answers for a chip or module of which only names are known."""

    depth: str = Field(description="what is emulated, and what is not")
    address: int = Field(description="of a chip its node")
    plain_axes: list[ListedAxisState]
    faults: WireFaultsState
