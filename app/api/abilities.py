"""What only some families of devices can. Where a device cannot, the route answers 409 and a way out."""

from __future__ import annotations

from typing import Annotated, Protocol, runtime_checkable

from fastapi import Depends

from ..devices.core.results import EventPage, RegisterReading, TmclExchange
from ..errors import WrongState
from .deps import CurrentDevice


@runtime_checkable
class TmclDevice(Protocol):
    """Speaks TMCL."""

    async def tmcl(self, opcode: int, type_: int = 0, motor: int = 0, value: int = 0, /) -> TmclExchange:
        """One command as it is. Raises LinkError; a bad status is an answer."""
        ...


@runtime_checkable
class StoringDevice(Protocol):
    """Has an EEPROM that keeps parameters."""

    async def store(self, name: str, axis: int | None = None) -> RegisterReading:
        """Copy a parameter to EEPROM. Raises UnknownThing, and WrongState where that one cannot be stored."""
        ...

    async def restore(self, name: str, axis: int | None = None) -> RegisterReading:
        """Copy a parameter back from EEPROM."""
        ...


@runtime_checkable
class EventfulDevice(Protocol):
    """Has an event register, whose edges are kept as a timeline."""

    def events(self, axis: int, after: int = 0, limit: int = 1000, /) -> EventPage:
        """The oldest `limit` entries behind number `after`. Raises UnknownThing for the axis."""
        ...


@runtime_checkable
class EncodedDevice(Protocol):
    """Can take its position from an encoder."""

    async def position_from_encoder(self, axis: int, /) -> int:
        """Call the place where the motor stands what its encoder shows; the difference. Raises WrongState."""
        ...


@runtime_checkable
class FlaggedDevice(Protocol):
    """Keeps flags until somebody has taken notice of them."""

    async def clear_flags(self, axis: int, /) -> None: ...


async def _encoded_device(device: CurrentDevice) -> EncodedDevice:
    if not isinstance(device, EncodedDevice):
        raise WrongState(f"a {device.family.title} cannot take its position from an encoder", "search its reference")
    return device


async def _flagged_device(device: CurrentDevice) -> FlaggedDevice:
    if not isinstance(device, FlaggedDevice):
        raise WrongState(f"a {device.family.title} keeps no flags", "its condition tells what is so now")
    return device


async def _eventful_device(device: CurrentDevice) -> EventfulDevice:
    if not isinstance(device, EventfulDevice):
        raise WrongState(f"a {device.family.title} has no event register", "its flags are in the axis's state")
    return device


async def _tmcl_device(device: CurrentDevice) -> TmclDevice:
    if not isinstance(device, TmclDevice):
        raise WrongState(f"a {device.family.title} speaks no TMCL", "send it a datagram: POST .../exchange")
    return device


async def _storing_device(device: CurrentDevice) -> StoringDevice:
    if not isinstance(device, StoringDevice):
        raise WrongState(f"a {device.family.title} has no EEPROM", "keep its profile: GET .../profile")
    return device


CurrentEventfulDevice = Annotated[EventfulDevice, Depends(_eventful_device)]
CurrentTmclDevice = Annotated[TmclDevice, Depends(_tmcl_device)]
CurrentStoringDevice = Annotated[StoringDevice, Depends(_storing_device)]
CurrentEncodedDevice = Annotated[EncodedDevice, Depends(_encoded_device)]
CurrentFlaggedDevice = Annotated[FlaggedDevice, Depends(_flagged_device)]
