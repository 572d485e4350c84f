"""Whether a TMC4361 answers: VERSION_NO is a small number, and CLK_FREQ the clock that it was told."""

from __future__ import annotations

from ...links.queue import LinkQueue
from ...links.register_access import RegisterAccess
from ...registers.tmc4361.table import CLOCK_HZ_MAX, CLOCK_HZ_MIN
from ..core.register_io import read_once_more

MODEL = "tmc4361"
VERSION_NO, CLK_FREQ = 0x7F, 0x31


def is_one(version: int, clock_hz: int) -> bool:
    """Whether these are words of a TMC4361."""
    return not version >> 4 and CLOCK_HZ_MIN <= clock_hz <= CLOCK_HZ_MAX


async def found_by(queue: LinkQueue, access: RegisterAccess) -> tuple[str, ...]:
    """Its model, where something else was expected and a TMC4361 is there; else empty."""
    version = await read_once_more(queue, VERSION_NO, access)
    return (MODEL,) if is_one(version, await read_once_more(queue, CLK_FREQ, access)) else ()
