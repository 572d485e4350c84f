"""What answers where another chip of 40-bit datagrams was expected: each family says how it is known."""

from __future__ import annotations

import contextlib

from ..errors import BadReply
from ..links.queue import LinkQueue
from ..links.register_access import RegisterAccess
from .tmc5xxx import identity as tmc5xxx
from .tmc4361 import identity as tmc4361

FAMILIES = (tmc4361.found_by, tmc5xxx.found_by)


async def models_found(queue: LinkQueue, access: RegisterAccess) -> tuple[str, ...]:
    """Models of the chip that answers, by its own words; empty where none of them is known. Only reads.

    Raises LinkError.
    """
    for found_by in FAMILIES:
        with contextlib.suppress(BadReply):
            if models := await found_by(queue, access):
                return models
    return ()
