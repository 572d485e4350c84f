"""Which TMC5xxx answers: VERSION, the upper byte of IOIN (INPUT)."""

from __future__ import annotations

from ...links.queue import LinkQueue
from ...links.register_access import RegisterAccess
from ...registers.tmc5xxx.models import MODELS
from ..core.register_io import read_once_more

VERSIONS = {model.name: model.version for model in MODELS if model.version is not None}
INPUTS = 0x04
SURE = frozenset(VERSIONS.values()) - {0x01}
"""Versions that other chips are not likely to show at that address by chance."""


def models_of(version: int) -> tuple[str, ...]:
    """The models whose VERSION that is."""
    return tuple(model for model, number in VERSIONS.items() if number == version)


async def found_by(queue: LinkQueue, access: RegisterAccess) -> tuple[str, ...]:
    """The TMC5xxx that may be there, where something else was expected; empty where nothing speaks for one."""
    version = await read_once_more(queue, INPUTS, access) >> 24
    return models_of(version) if version in SURE else ()
