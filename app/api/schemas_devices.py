"""How connections come in: the kinds of links, each with its own options."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, StringConstraints

from app.api.schemas import AxisConfig, Body, ClockHz, ModelName, Name
from app.emulators.options import EmulatorOptions

HOST = (
    r"^[A-Za-z0-9_]([A-Za-z0-9_-]{0,62})(\.[A-Za-z0-9_-]{1,63})*\.?$|^[0-9A-Fa-f:.]*:[0-9A-Fa-f:.]*(%[A-Za-z0-9_-]+)?$"
)
"""A name of labels of up to 63 characters, an IPv4 address (which looks like one), or an IPv6 address."""


class EmulatorLink(EmulatorOptions):
    """A chip emulated in this server. Without options it gets a motor and a stage on each axis."""

    kind: Literal["emulator"]


class TcpLink(Body):
    """A chip behind a TCP socket: raw 4-byte frames both ways, as `stepscope emulate` serves them."""

    kind: Literal["tcp"]
    host: Annotated[str, StringConstraints(strict=True, max_length=253, pattern=HOST)] = Field(
        description="name or address of the machine"
    )
    port: Annotated[int, Field(strict=True, ge=1, le=65_535)]
    timeout_s: Annotated[float, Field(strict=True, ge=0.001, le=60, allow_inf_nan=False)] = Field(
        default=1.0, description="how long to wait for an answer [s]"
    )


LinkIn = Annotated[EmulatorLink | TcpLink, Field(discriminator="kind")]
Axes = Annotated[list[AxisConfig], Field(max_length=8)]


class DeviceCreate(Body):
    """A connection. Axes that are not given get defaults."""

    name: Name
    model: ModelName
    link: LinkIn
    clock_hz: ClockHz | None = Field(default=None, description="the chip's clock [Hz]; null: 16 MHz")
    axes: Axes | None = None


class DeviceChange(Body):
    """What to change; what is left out stays."""

    name: Name | None = None
    link: LinkIn | None = None
    clock_hz: ClockHz | None = None
    axes: Axes | None = None


class DeviceTrial(Body):
    """A link to be tried."""

    model: ModelName
    link: LinkIn
