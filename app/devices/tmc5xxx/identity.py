"""Which TMC5xxx answers: VERSION, the upper byte of IOIN (INPUT)."""

from __future__ import annotations

from ...links.queue import LinkQueue
from ...links.register_access import RegisterAccess
from ..core.register_io import read_once_more

VERSIONS = {"tmc5031": 0x01, "tmc5062": 0x01, "tmc5072": 0x10, "tmc5130": 0x11, "tmc5160": 0x30}
"""VERSION of the first silicon of each, by their data sheets. A later one may have another, but not that of another
chip."""
INPUTS, GCONF = 0x04, 0x00
SURE = frozenset({0x10, 0x11, 0x30})
"""Versions that other chips are not likely to show at that address by chance."""


def models_of(version: int) -> tuple[str, ...]:
    """The models whose VERSION that is."""
    return tuple(model for model, number in VERSIONS.items() if number == version)


async def found_by(queue: LinkQueue, access: RegisterAccess) -> tuple[str, ...]:
    """The TMC5xxx that may be there, where something else was expected; empty where nothing speaks for one."""
    version = await read_once_more(queue, INPUTS, access) >> 24
    return models_of(version) if version in SURE else ()
